# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Every public name of the C++ headers is in the package, or there is a reason why not."""

import pathlib
import re

import pytest

import morula

headers = pathlib.Path(__file__).resolve().parents[2] / "include" / "morula"

#: What is something else in Python, and what that is.
ELSEWHERE = {
    "BuildOptions": "build", "CoverOptions": "cover", "CollideOptions": "collide", "ContactStatus": "Contacts",
    "DistanceOptions": "distance", "TouchOptions": "touch", "Ray": "first_hit", "RayQuery": "first_hits", "TouchQuery": "touch",
    "MeasureOptions": "measure", "VoxelGrid": "looseness", "MeshView": "Mesh", 
    "MotionOptions": "read_motion", "Motion": "read_motion", "MotionWriter": "write_motion",
    "ModalCoordinates": "read_coordinates", "BoneFrames": "read_bone_frames", "SphereFrames": "read_sphere_frames",
    "SphereFramesWriter": "write_sphere_frames", "ReadTreeOptions": "read_tree", "UpdateOptions": "Body", "RuleOptions": "Body",
    "RebuildOptions": "RebuiltBody", "RebuildThread": "RebuiltBody", "KnownPoseOptions": "with_known_poses", "NamedPose": "KnownPose",
    "add_known_poses": "with_known_poses", "SceneBodyOptions": "Scene", 
    "ProximityOptions": "ProximityQuery", "ProximityPair": "ProximityPairs", "SweptOptions": "SweptQuery", "SweptPair": "SweptPairs",
    "SurfaceCrossingOptions": "SurfaceCrossingQuery", "PairFilter": "ProximityQuery", "FacetMasks": "ProximityQuery",
    "OpenFacets": "ProximityQuery", "FeaturePair": "FeaturePairs", "ObstacleOptions": "ObstacleQuery",
    "ObstacleFeatures": "ObstacleQuery", "ObstacleContact": "ObstacleContacts", "ObstacleImpact": "ObstacleImpacts",
    "PenetrationOptions": "PenetrationQuery", "ModalCertificateOptions": "ModalCertificate", "ClumpOptions": "fit_clump",
    "ClumpKind": "fit_clump", "RepairOptions": "repair", "RepairedMesh": "repair", "UsedVertices": "used_vertices",
    "Contact": "Contacts", "ContactSurface": "ContactSurfaces", "Crossing": "Crossings", "FrontPair": "FrontPairs",
    "PairWalkOptions": "walk_pairs", "Step": "walk_pairs", "NodePair": "walk_pairs", "Priority": "collide",
    "ClosestFacetPoint": "ClosestPoints", "SignMethod": "SignedDistance", 
    "CutPoint": "Cover", "Segment": "intersection", "VtpArray": "write_vtp", "VtpData": "write_vtp", "PvdEntry": "write_pvd",
    "MeshFileKind": "file_formats", "mesh_file_kinds": "file_formats", "PosedTree": "PosedSpheres",
    "Method": "all_methods", "Reduction": "all_reductions", "Optimiser": "all_optimisers", "Quality": "all_qualities",
    "Rule": "all_rules", "Axis": "Bend", "method_from_name": "all_methods", "quality_from_name": "all_qualities",
    "reduction_from_name": "all_reductions", "optimiser_from_name": "all_optimisers", "rule_from_name": "all_rules",
    "LoosenessEstimator": "estimate_looseness", "FitSampler": "measure", "SampleCounts": "measure",
    "PageMotion": "page", "PageContact": "page", "PageScene": "page", "PageContent": "page", "follow_motion": "page",
    "show_spheres": "page", "make_page": "page", "has_page": "page", "why_no_page": "page", "validate": "CoveredTree",
    "inverse": "RigidTransform", "inside_volume": "SignedDistance", "outside_volume": "SignedDistance", "FileError": "BuildStopped",
    "is_rule": "all_rules", "traits": "rule_table", "covers_alone": "rule_table", "covers": "Body", "side_ends": "Connectivity",
    "any_promises_cover": "Body", "any_promises_nesting": "Body", "certify_promised_levels": "Body", "certify_promised_nesting": "Body",
    "describe_rules": "Body", "rule_of_level": "Body", "CutFacet": "PowerDiagram", "FacetGeometry": "PowerDiagram",
    "least_growth": "PowerDiagram", "describe": "deform", "tree_hash": "SphereTree",
    "BoxPair": "BroadPhase", "InnerBallOptions": "inner_ball_candidates", "PageJoints": "page", "SceneOptions": "Scene", "AffineTransform": "move_by_skin", "level_set_spheres": "SphereTree", "require_usable": "Mesh", 
    "Front": "ContactQuery",
    "SceneTouch": "Scene", "corner_position": "Cover", "area": "surface_area",
}
#: What Python or NumPy has already, and what only somebody who writes C++ calls.
LEFT_OUT = {
    "geometry/vector.hpp", "geometry/random.hpp", "geometry/trigonometry.hpp", "geometry/positions.hpp", "geometry/scale.hpp",
    "geometry/sphere.hpp", "geometry/box.hpp", "geometry/status.hpp", "io/csv.hpp", "io/whole_output.hpp", "parallel/stopwatch.hpp",
    "parallel/workers.hpp", "collide/pair_tests.hpp", "query/brute_force.hpp", "collide/budget.hpp", "tree/walk.hpp",
}
LEFT_OUT_NAMES = {
    "askable": "collide() asks it", "refused": "an exception", "narrow_spheres": "PosedSpheres.set() does it", "cut_by_power": "works in the caller's memory",
    "farthest_reach": "a line of NumPy", "farthest_distance": "a line of NumPy", "area_vector": "a line of NumPy",
    "at_barycentric": "a line of NumPy", "largest_coordinate": "a line of NumPy", "is_finite": "numpy.isfinite", 
}


def declared(header):
    """Names at the outermost level of the namespace."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", header.read_text(encoding="utf-8"), flags=re.S)
    text = re.sub(r"namespace (detail|brute_force) \{.*?\n\} *\n", "", text, flags=re.S)
    names = []
    for line in text.splitlines():
        if scope := re.match(r"(?:template <[^>]*>\s*)?(?:struct|class|enum class)\s+(\w+)[^;]*\{", line):
            names.append(scope.group(1))
        elif constant := re.match(r"inline constexpr [\w:]+ (\w+)", line):
            names.append(constant.group(1))
        elif not re.match(r"\s|using|namespace|#|template|struct|class|enum|inline constexpr|static_assert|}", line):
            if call := re.match(r"[\w:<>,&* \[\]]*?\b(\w+)\(", line):
                names.append(call.group(1))
    return list(dict.fromkeys(names))


def folders():
    for header in sorted(headers.rglob("*.hpp")):
        name = header.relative_to(headers).as_posix()
        if name not in LEFT_OUT and not name.startswith("study/") and name != "morula.hpp":
            yield pytest.param(header, id=name)


@pytest.mark.parametrize("header", list(folders()))
def test_names_of_a_header_are_in_the_package(header):
    robots = header.parent.name == "robot"
    if robots and not hasattr(morula._morula, "robot"):
        pytest.skip("this package was built without robots")
    there = set(dir(morula._morula.robot)) if robots else set(dir(morula._morula)) | set(morula.__all__)
    words = {
        "FitOptions": "fit_spheres", "ReadOptions": "read_robot", "SelfCollisionOptions": "find_ignored", "OutputOptions": "OutputFormat",
        "Description": "OutputFormat", "OutputFile": "OutputFormat", "IgnoreReason": "IgnoredPair", "ClipPlane": "fit_spheres", "RoundShapes": "surface_of", "none": "Robot", "name": "IgnoredPair",
    } if robots else ELSEWHERE
    names = [name for name in declared(header) if name not in ("name", "message") or robots]
    missing = [name for name in names if name not in there and name not in LEFT_OUT_NAMES and words.get(name) not in there]
    assert missing == []


def test_what_is_elsewhere_is_there():
    there = set(dir(morula._morula)) | set(morula.__all__)
    assert {place for place in ELSEWHERE.values() if place not in there} == set()
