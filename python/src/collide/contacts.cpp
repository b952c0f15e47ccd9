// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Results of queries about two bodies: contacts, crossings, containment.
#include "contacts.hpp"

#include <morula/morula.hpp>

#include "module.hpp"
#include "records.hpp"

namespace morula::python {

void bind_contacts(nb::module_& m) {
  Record<SurfacePoint>(m, "SurfacePoint", doc::SurfacePoint)
      .field("facet", &SurfacePoint::facet)
      .field("barycentric", &SurfacePoint::barycentric)
      .field("point", &SurfacePoint::point);
  Record<Crossings>(m, "Crossings", "Pairs of facets that intersect, in the order of (facet_a, facet_b).")
      .property("facet_a", MORULA_COLUMN(Crossings, pairs, facet_a), "(n,) uint32.")
      .property("facet_b", MORULA_COLUMN(Crossings, pairs, facet_b), "(n,) uint32.")
      .property("segment_from", MORULA_COLUMN3(Crossings, pairs, segment.from), "(n, 3) float64, world coordinates.")
      .property("segment_to", MORULA_COLUMN3(Crossings, pairs, segment.to), "(n, 3) float64, world coordinates.")
      .table([](const Crossings& self) { return self.pairs.size(); });
  Record<ContactSurfaces>(m, "ContactSurfaces", doc::ContactSurface)
      .property("facet_a", MORULA_COLUMN(ContactSurfaces, rows, on_a.facet), "(n,) uint32.")
      .property("facet_b", MORULA_COLUMN(ContactSurfaces, rows, on_b.facet), "(n,) uint32.")
      .property("barycentric_a", MORULA_COLUMN3(ContactSurfaces, rows, on_a.barycentric), "(n, 3) float64.")
      .property("barycentric_b", MORULA_COLUMN3(ContactSurfaces, rows, on_b.barycentric), "(n, 3) float64.")
      .property("point_a", MORULA_COLUMN3(ContactSurfaces, rows, on_a.point), "(n, 3) float64, world coordinates.")
      .property("point_b", MORULA_COLUMN3(ContactSurfaces, rows, on_b.point), "(n, 3) float64, world coordinates.")
      .property("normal", MORULA_COLUMN3(ContactSurfaces, rows, normal), doc::ContactSurface_normal)
      .property("depth", MORULA_COLUMN(ContactSurfaces, rows, depth), doc::ContactSurface_depth)
      .table([](const ContactSurfaces& self) { return self.rows.size(); });
  Record<Containment>(m, "Containment", doc::Containment)
      .property(
          "inside", [](const Containment& c) { return std::vector<bool>(c.inside.begin(), c.inside.end()); },
          doc::Containment_inside)
      .field("inside_count", &Containment::inside_count)
      .field("certified", &Containment::certified)
      .property("all", [](const Containment& c) { return c.all(); })
      .property("any", [](const Containment& c) { return c.any(); });
  Record<MutualContainment>(m, "MutualContainment", doc::MutualContainment)
      .field("a_in_b", &MutualContainment::a_in_b)
      .field("b_in_a", &MutualContainment::b_in_a);
  Record<Contacts> contacts(
      m, "Contacts", "Pairs of nodes whose spheres overlap; every crossing of the surfaces lies in one of them.");
  contacts.property("pair", MORULA_COLUMN(Contacts, contacts, pair), doc::Contact_pair);
  contact_columns(contacts)
      .property(
          "surfaces", [](const Contacts& c) { return ContactSurfaces{c.surfaces}; }, doc::Contacts_surfaces)
      .property(
          "crossings", [](const Contacts& c) { return Crossings{c.crossings}; }, doc::Contacts_crossings)
      .property("crossings_begin", [](const Contacts& c) { return c.crossings_begin; })
      .property(
          "containment", [](const Contacts& c) { return c.containment; }, doc::Contacts_containment)
      .property(
          "finished_count", [](const Contacts& c) { return c.finished_count; }, doc::Contacts_finished_count)
      .property(
          "is_finished", [](const Contacts& c) { return c.finished; }, doc::Contacts_finished)
      .property(
          "pair_tests", [](const Contacts& c) { return c.pair_tests; }, doc::Contacts_pair_tests)
      .property(
          "achieved_level", [](const Contacts& c) { return c.achieved_level; }, doc::Contacts_achieved_level)
      .table([](const Contacts& self) { return self.contacts.size(); });
}

}  // namespace morula::python
