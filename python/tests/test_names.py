# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Every public name of the C++ headers is in the package, or there is a reason why not."""

import pathlib
import re
import subprocess
import sys

import pytest

import morula

root = pathlib.Path(__file__).resolve().parents[2]
headers = root / "include" / "morula"

#: What is something else in Python, and what that is.
ELSEWHERE = {
    "BuildOptions": "build", "CoverOptions": "cover", "CollideOptions": "collide", "ContactStatus": "Contacts",
    "DistanceOptions": "distance", "TouchOptions": "touch", "Ray": "first_hit", "RayQuery": "first_hits",
    "TouchQuery": "touch", "MeasureOptions": "measure", "VoxelGrid": "looseness", "MeshView": "Mesh", "to_mesh": "Mesh",
    "MotionOptions": "Motion", "ModalCoordinates": "read_coordinates", "BoneFrames": "read_bone_frames",
    "ReadTreeOptions": "read_tree", "UpdateOptions": "Body", "RuleOptions": "Body",
    "RebuildOptions": "RebuiltBody", "RebuildEffort": "RebuiltBody", "RebuildThread": "RebuiltBody", "KnownPoseOptions": "with_known_poses",
    "NamedPose": "KnownPose", "add_known_poses": "with_known_poses", "SceneBodyOptions": "Scene",
    "ProximityOptions": "ProximityQuery", "ProximityPair": "ProximityPairs", "SweptOptions": "SweptQuery",
    "SweptPair": "SweptPairs", "SurfaceCrossingOptions": "SurfaceCrossingQuery", "PairFilter": "ProximityQuery",
    "FacetMasks": "ProximityQuery", "OpenFacets": "ProximityQuery", "FeaturePair": "FeaturePairs",
    "LayerPatchOptions": "LayerPatchQuery", "LayerPatch": "LayerPatches", "LayerSide": "LayerRegions", "LayerPoint": "LayerPoints",
    "ObstacleOptions": "ObstacleQuery", "ObstacleFeatures": "ObstacleQuery", "ObstacleContact": "ObstacleContacts",
    "ObstacleImpact": "ObstacleImpacts", "PenetrationOptions": "PenetrationQuery",
    "ModalCertificateOptions": "ModalCertificate", "ClumpOptions": "fit_clump", "ClumpKind": "fit_clump",
    "RepairOptions": "repair", "RepairedMesh": "repair", "UsedVertices": "used_vertices", "Contact": "Contacts",
    "ContactPatchOptions": "ContactPatchQuery", "ContactPatch": "ContactPatches", "PatchSide": "PatchRegions",
    "PatchFacet": "PatchRegions", "VertexGradient": "PatchRegions", "PatchPoint": "PatchPoints",
    "ContactSurface": "ContactSurfaces", "Crossing": "Crossings", "FrontPair": "FrontPairs",
    "EarliestTouchOptions": "earliest_touch", "EarliestTouchQuery": "earliest_touch", "HapticOptions": "HapticProbe", "HapticToolOptions": "HapticTool", "PairWalkOptions": "walk_pairs", "Step": "walk_pairs", "NodePair": "walk_pairs", "Priority": "collide",
    "ClosestFacetPoint": "ClosestPoints", "SignMethod": "SignedDistance", "CutPoint": "Cover", "Segment": "intersection",
    "VtpArray": "write_vtp", "VtpData": "write_vtp", "PvdEntry": "write_pvd", "MeshFileKind": "file_formats",
    "mesh_file_kinds": "file_formats", "MeshInfo": "read_mesh", "SphereState": "PosedSpheres", "Method": "all_methods",
    "Reduction": "all_reductions", "Optimizer": "all_optimizers", "Quality": "all_qualities", "Rule": "all_rules",
    "Axis": "Bend", "method_from_name": "all_methods", "quality_from_name": "all_qualities",
    "reduction_from_name": "all_reductions", "optimizer_from_name": "all_optimizers", "rule_from_name": "all_rules",
    "SampleCounts": "FitSampler", "PageContent": "make_page", "validate": "CoveredTree.validate",
    "inverse": "RigidTransform", "inside_volume": "SignedDistance.inside_volume",
    "outside_volume": "SignedDistance.outside_volume", "traits": "rule_table", "covers_alone": "RuleTraits.covers",
    "covers": "Body.covers", "side_ends": "Connectivity", "any_promises_cover": "Body.any_promises_cover",
    "any_promises_nesting": "Body.any_promises_nesting", "certify_promised_levels": "Body.certify_promised_levels",
    "certify_promised_nesting": "Body.certify_promised_nesting", "FacetGeometry": "cut_by_power",
    "least_growth": "PowerDiagram.least_growth", "tree_hash": "SphereTree.hash", "BoxPair": "BroadPhase",
    "InnerBallOptions": "inner_ball_candidates", "SceneOptions": "Scene", "SceneFilter": "Scene.all_hits", "SceneReserve": "Scene.reserve", "SceneRayHits": "Scene.all_hits", "SweepQuery": "sweep", "SceneSweepHits": "Scene.sweep_all", "AffineTransform": "move_by_skin", "Boxf": "SkinBounds.bounds", "SkinBoundsOutput": "SkinBounds.bounds", "SkinBoundsCluster": "SkinBounds.clusters", "SkinBoundsRow": "SkinBounds.rows", "SkinBoundsTarget": "SkinBounds.targets", "SkinBoundsData": "SkinBounds",
    "level_set_spheres": "SphereTree.level_set_spheres", "area": "surface_area",
}
#: Headers of which nothing is in the package, and why.
LEFT_OUT = {
    "geometry/vector.hpp": "points are tuples and arrays", "geometry/sphere.hpp": "spheres are tuples and arrays",
    "geometry/box.hpp": "a box is two corners", "geometry/positions.hpp": "any array is taken as it is",
    "geometry/reproducible.hpp": "numpy; what needs its bits is in C++",
    "geometry/scale.hpp": "checks that every function makes", "geometry/status.hpp": "a refusal is an exception",
    "io/file_reference.hpp": "readers ask it", "io/whole_output.hpp": "every writer of the package writes whole files",
    "parallel/interrupt.hpp": "Ctrl-C", "parallel/snapshots.hpp": "a template for threads of C++; a body of Python is locked while a call reads it", "parallel/workers.hpp": "Workers is there; loops of one's own are Python's",
    "collide/budget.hpp": "an int, a timedelta or a text",
    "io/skin_bounds_file.hpp": "the command `morula bounds` writes these files; JSON is Python's own",
    "tree/walk.hpp": "a template over functions: each step would call Python",
}
LEFT_OUT_NAMES = {
    "FileError": "an OSError", "SystemFileError": "an OSError of the kind of its errno", "rigid_or_throw": "set_transform() does it", "is_rule": "rules are text", "require_usable": "every function that takes a mesh checks it",
    "describe": "a deformation prints itself", "corner_position": "a line of NumPy with Cover.cut_vertices and cut_weights",
    "add_marks": "CollidePage.add does it", "PagePatchFacet": "CollidePage.add makes them of ContactPatches", "PagePatches": "CollidePage.add makes them of ContactPatches", "askable": "collide() asks it", "refused": "an exception", "narrow_spheres": "PosedSpheres.set() does it",
    "farthest_reach": "a line of NumPy", "farthest_distance": "a line of NumPy", "area_vector": "a line of NumPy",
    "at_barycentric": "a line of NumPy", "largest_coordinate": "a line of NumPy", "is_finite": "numpy.isfinite",
    "StopToken": "KeyboardInterrupt and progress functions", "StopSource": "KeyboardInterrupt and progress functions",
}


def declared(header):
    """Names at the outermost level of the namespace."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", header.read_text(encoding="utf-8"), flags=re.S)
    text = re.sub(r"namespace (detail|brute_force) \{.*?\n\} *\n", "", text, flags=re.S)
    names = []
    for line in text.splitlines():
        if scope := re.match(r"(?:template <[^>]*>\s*)?(?:struct|class|enum class)\s+(?:\[\[nodiscard\]\]\s+)?(\w+)[^;]*\{", line):
            names.append(scope.group(1))
        elif constant := re.match(r"inline constexpr [\w:]+ (\w+)", line):
            names.append(constant.group(1))
        elif not re.match(r"\s|using|namespace|#|template|struct|class|enum|inline constexpr|static_assert|}", line):
            if call := re.match(r"[\w:<>,&* \[\]]*?\b(\w+)\(", line):
                names.append(call.group(1))
    return list(dict.fromkeys(names))


def folders():
    extras = [folder for folder in root.glob("extras/*/include/morula") if folder.parts[-3] != "study"]
    for folder, header in sorted((folder, header) for folder in [headers, *extras] for header in folder.rglob("*.hpp")):
        name = header.relative_to(folder).as_posix()
        if name not in LEFT_OUT and name != "morula.hpp":
            yield pytest.param(header, id=name)


@pytest.mark.parametrize("header", list(folders()))
def test_names_of_a_header_are_in_the_package(header):
    robots = header.parent.name == "robot"
    if robots and not hasattr(morula._morula, "robot"):
        pytest.skip("this package was built without robots")
    if header.parent.name == "page" and not hasattr(morula, "PageScene"):
        pytest.skip("this package was built without the page")
    if header.parent.name == "grains" and not hasattr(morula, "fit_clump"):
        pytest.skip("this package was built without clumps")
    there = set(dir(morula._morula.robot)) if robots else set(dir(morula._morula)) | set(morula.__all__)
    words = {
        "FitOptions": "fit_spheres", "ReadOptions": "read_robot", "SelfCollisionOptions": "find_ignored", "OutputOptions": "OutputFormat",
        "Description": "OutputFormat", "OutputFile": "OutputFormat", "IgnoreReason": "IgnoredPair", "ClipPlane": "fit_spheres", "RoundShapes": "surface_of", "none": "Robot", "name": "IgnoredPair",
        "ConfigurationVerdict": "ConfigurationVerdicts", "HeightField": "World", "NearestObstacle": "World",
        "Clearance": "Clearances", "ClearanceOptions": "ConfigurationQuery", "MotionVerdict": "MotionVerdicts", "MotionOptions": "ConfigurationQuery",
        "SelfRateOptions": "self_collision_rates", "SelfFitOptions": "fit_for_self_collision",
    } if robots else ELSEWHERE
    names = [name for name in declared(header) if name not in ("name", "message") or robots]
    missing = [name for name in names if name not in there and name not in LEFT_OUT_NAMES and name not in words]
    assert missing == []
    # What has its own name is not listed.
    assert [name for name in names if name in there and (name in LEFT_OUT_NAMES or name in words)] == []


# Not in packages that were built without the extras.
OF_EXTRAS = ("fit_clump", "make_page")


def test_what_is_elsewhere_is_there():
    for place in ELSEWHERE.values():
        name, _, member = place.partition(".")
        if name in OF_EXTRAS and not hasattr(morula, name):
            continue
        assert name in morula.__all__ and (not member or hasattr(getattr(morula, name), member)), place


def test_what_is_left_out_is_there_in_cpp():
    assert [name for name in LEFT_OUT if not (headers / name).is_file()] == []
    every = {name for folder in [headers, *root.glob("extras/*/include/morula")] for header in folder.rglob("*.hpp") for name in declared(header)}
    assert [name for name in (*LEFT_OUT_NAMES, *ELSEWHERE) if name not in every] == []


def test_public_names_are_on_record():
    """tests/golden/python_names.txt has all names of a package with all its parts; scripts/abi --refresh writes it."""
    package = pathlib.Path(morula.__file__).parent
    if not (package / "_morula" / "robot.pyi").exists() or not (package / "studies.py").exists():
        pytest.skip("the package was built without robots or the study, or without stubs")
    done = subprocess.run([sys.executable, root / "scripts" / "abi", "--names", "--python", package], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
