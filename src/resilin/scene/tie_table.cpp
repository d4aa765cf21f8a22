#include "resilin/scene/tables.hpp"

namespace resilin {
namespace {

int read_component(const SceneNode& node) {
  const bool is_3d = node.context->dimension == 3;
  return read_choice(
             node, is_3d ? std::vector<std::string>{"x", "y", "z"} : std::vector<std::string>{"x", "y"})[0] -
         'x';
}

Keys<ConstraintTerm> constraint_term_keys() {
  using T = ConstraintTerm;
  return {
      text_key("body", &T::body, "the only body", "Name of the body."),
      key<T>({"where", "[where](#where)", "", "required", "Which vertices; their mean displacement counts."},
             [](const SceneNode& node, T& t) { read_where(node, t.where); }),
      key<T>({"component", "letter", "", "required", "\"x\", \"y\" or \"z\"."},
             [](const SceneNode& node, T& t) { t.axis = read_component(node); }),
      number_key("coefficient", &T::coefficient, "", any_number, "Factor on the displacement."),
  };
}

void read_term(const SceneNode& node, ConstraintTerm& term) {
  term.place = node.place();
  read_table(node, constraint_term_keys(), term);
}

/// Keys that a kind of constraint has.
std::vector<std::string> keys_of(ConstraintKind kind) {
  switch (kind) {
    case ConstraintKind::equal:
      return {"body", "where", "components"};
    case ConstraintKind::equation:
      return {"terms", "value", "time_function"};
    case ConstraintKind::periodic:
      break;
  }
  return {"body", "components", "gradient", "time_function"};
}

Keys<TiedSurface> tied_surface_keys() {
  using S = TiedSurface;
  return {
      key<S>({"body", "text", "", "required", "Name of the body."},
             [](const SceneNode& node, S& s) { s.body = read_text(node); }),
      key<S>({"where", "[where](#where)", "", "the whole surface", "Facets with all vertices selected."},
             [](const SceneNode& node, S& s) { read_where(node, s.where); }),
  };
}

void read_surface(const SceneNode& node, TiedSurface& surface) {
  surface.place = node.place();
  read_table(node, tied_surface_keys(), surface);
}

}  // namespace

Keys<TieDescription> tie_keys() {
  using T = TieDescription;
  return {
      text_key("name", &T::name, "tie[0] ...",
               "Name of the force in the report: that on the surface that follows."),
      key<T>({"surfaces", "two tables { body, where }", "", "required",
              "The surface that follows, the one with finer facets, and the one that it follows; without "
              "`where` all of a body's surface."},
             [](const SceneNode& node, T& t) {
               expect_list(node, "tables { body, where }", 2);
               for (std::size_t i = 0; i < t.surfaces.size(); ++i)
                 read_surface(node.element(i), t.surfaces[i]);
             }),
      key<T>({"gap", "\"keep\" or \"close\"", "", "\"keep\"", "What becomes of an initial gap."},
             [](const SceneNode& node, T& t) {
               t.closes_gap = read_choice(node, {"keep", "close"}) == "close";
             }),
      key<T>({"max_distance", "number > 0", "m", "half the size of the following facets",
              "Largest initial distance of the surfaces."},
             [](const SceneNode& node, T& t) { t.max_distance = read_number(node, positive); }),
  };
}

void read_tie(const SceneNode& node, TieDescription& tie) {
  tie.place = node.place();
  tie.name = node.path;
  read_table(node, tie_keys(), tie);
}

Keys<ConstraintDescription> constraint_keys() {
  using C = ConstraintDescription;
  return {
      text_key("name", &C::name, "constraint[0] ...", "Name of the force in the report."),
      choice_key(
          "kind", &C::kind,
          "equal: the vertices of `where` share their displacement. equation: a weighted sum of mean "
          "displacements is `value`. periodic: opposite faces of the box around a body move alike, but "
          "for `gradient`."),
      text_key("body", &C::body, "the only body", "Equal, periodic: name of the body."),
      key<C>({"where", "[where](#where)", "", "required for equal", "Equal: which vertices."},
             [](const SceneNode& node, C& c) { read_where(node, c.where); }),
      key<C>({"components", "letters of \"xyz\"", "", "all",
              "Equal: the components. Periodic: the axes along which the cell repeats."},
             [](const SceneNode& node, C& c) { read_components(node, c.components); }),
      key<C>({"terms", "list of { body, where, component, coefficient }", "", "required for equation",
              "Equation: coefficient (default 1) times the mean displacement component of `where`, each."},
             [](const SceneNode& node, C& c) {
               expect_list(node, "tables { where, component, coefficient }");
               for (std::size_t i = 0; i < node.value->array().size(); ++i) {
                 c.terms.emplace_back();
                 read_term(node.element(i), c.terms.back());
               }
             }),
      number_key("value", &C::value, "m", any_number, "Equation: its right side at load factor 1."),
      matrix_key("gradient", &C::gradient, "",
                 "Periodic: mean displacement gradient of the cell at load factor 1."),
      key<C>({"time_function", "[time_function](#time_function)", "", "none",
              "Factor on value and gradient in place of the load factor."},
             [](const SceneNode& node, C& c) { read_time_function(node, c.time_function); }),
  };
}

void read_constraint(const SceneNode& node, ConstraintDescription& constraint) {
  constraint.place = node.place();
  constraint.name = node.path;
  read_table(node, constraint_keys(), constraint);
  const std::string kind(spelling(constraint.kind));
  const std::vector<std::string> has = keys_of(constraint.kind);
  for (const char* name : {"body", "where", "components", "terms", "value", "gradient", "time_function"})
    if (node.has(name) && std::ranges::find(has, name) == has.end())
      node.child(name).fail_with("kind \"" + kind + "\" has no such key; it has " + join(has));
  for (const char* name : {"where", "terms"})
    if (!node.has(name) && has[name == std::string("where") ? 1 : 0] == name)
      node.fail_with("kind \"" + kind + "\" needs the key \"" + name + "\"");
}

}  // namespace resilin
