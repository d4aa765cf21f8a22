#include "resilin/world/rigid_shape.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/dense.hpp"
#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/mesh/edit.hpp"
#include "resilin/mesh/facet.hpp"
#include "resilin/mesh/second_moments.hpp"
#include "resilin/world/body_material.hpp"
#include "resilin/world/body_mesh.hpp"
#include "resilin/world/description_check.hpp"
#include "resilin/world/meeting_surface.hpp"
#include "resilin/world/rigid_region.hpp"
#include "resilin/world/selection.hpp"

namespace resilin {
namespace {

using Dense = dense::Matrix;

/// Share of the extent: points nearer to a line or plane lie in it.
constexpr double flatness = 1e-6;
/// Control nodes with a diagonal mass matrix lie far away when the held point is near the centre of mass:
/// below this share of the mass elsewhere the matrix is a full one.
constexpr double least_share_elsewhere = 0.1;
/// The cell of the control nodes is at least so wide, in parts of its greatest width: strains of a thinner
/// one would be differences of positions without digits.
constexpr double least_width = 0.2;
// Young's modulus against stretching, in parts of what a body meets: stretches are about the inverse
// (docs/rigid.md).
constexpr double over_soft_bodies = 1e5, over_inertia = 1e3, over_stresses = 1e6;
/// Share of the unit of inertia rho (L/dt)^2 or rho g L by which contact of rigid bodies alone measures.
constexpr double contact_over_stresses = 1e3;

/// The affine hull of points: one of them, and directions of length 1 that are orthogonal to each other.
struct Hull {
  Vector3 origin = Vector3::Zero();
  std::vector<Vector3> directions;

  Vector3 beside(const Vector3& X) const {
    Vector3 rest = X - origin;
    for (const Vector3& direction : directions) rest -= direction * direction.dot(rest);
    return rest;
  }
};

Hull hull_of(std::span<const Vector3> points, int dim, double extent) {
  Hull hull{.origin = points.front(), .directions = {}};
  while (static_cast<int>(hull.directions.size()) < dim) {
    Vector3 farthest = Vector3::Zero();
    for (const Vector3& point : points)
      if (const Vector3 rest = hull.beside(point); rest.squaredNorm() > farthest.squaredNorm())
        farthest = rest;
    if (!(farthest.norm() > flatness * extent)) break;
    hull.directions.push_back(farthest.normalized());
  }
  return hull;
}

Hull hull_of(const RigidShape& shape, const std::vector<Index>& vertices, double extent) {
  std::vector<Vector3> points;
  for (const Index v : vertices) points.push_back(node_position(shape.dimension(), v, shape.rest_positions));
  return hull_of(points, shape.dimension(), extent);
}

double extent_of(const RigidShape& shape) {
  return largest_extent(shape.body, shape.rest_positions, shape.dimension());
}

/// Volume, in 2D area, of the cell of the control nodes; negative where it is turned inside out.
double size_of_cell(const RigidShape& shape) {
  const std::vector<Vector3>& X = shape.control_nodes;
  const Vector3 normal = (X[1] - X[0]).cross(X[2] - X[0]);
  return shape.dimension() == 2 ? normal.z() / 2 : normal.dot(X[3] - X[0]) / 6;
}

/// The same subspace by orthonormal columns whose first components are equal.
Dense balanced(const Dense& basis) {
  const Eigen::Index size = basis.cols();
  const VectorX first = basis.row(0).transpose();
  const VectorX wanted = VectorX::Constant(size, first.norm() / std::sqrt(static_cast<double>(size)));
  const VectorX v = first - wanted;
  if (!(v.squaredNorm() > 1e-28)) return basis;
  return basis - (basis * v) * (2 / v.squaredNorm()) * v.transpose();
}

/// Orthonormal columns: those of `vectors` one after another as far as they are independent.
Dense orthonormal(const Dense& vectors, Eigen::Index most) {
  Dense basis(vectors.rows(), 0);
  for (Eigen::Index k = 0; k < vectors.cols() && basis.cols() < most; ++k) {
    VectorX v = vectors.col(k);
    for (int twice = 0; twice < 2; ++twice) v -= basis * (basis.transpose() * v);
    if (!(v.norm() > 1e-9 * vectors.col(k).norm())) continue;
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.rightCols(1) = v.normalized();
  }
  return basis;
}

/// In coordinates y in which the body has the diagonal second moments S about its centre of mass, the mass
/// matrix of control nodes y_a is m P^-T diag(1, S) P^-1, the rows of P being (1, y_a). With S = 1 it is
/// diagonal where these rows are orthogonal: any orthonormal basis gives such nodes, and the first of it may
/// span a point or a line.
/// @param L  X = centre + L y
/// @param S  less than one where the body is thinner than its cell
void place_control_nodes(const Hull* held, const Vector3& centre, const Dense& L, const VectorX& S,
                         RigidShape& shape) {
  const Eigen::Index n = shape.dimension() + 1;
  const Dense L_inverse = dense::inverse(L);
  const auto y_of = [&](const Vector3& X) {
    VectorX row(n);
    row[0] = 1;
    row.tail(n - 1) = L_inverse * (X - centre).head(n - 1);
    return row;
  };
  Dense P = Dense::Identity(n, n);
  if (held == nullptr) {
    P = balanced(P).transpose();
  } else {
    const auto r = static_cast<Eigen::Index>(held->directions.size()) + 1;
    Dense vectors = Dense::Zero(n, r + n);
    vectors.col(0) = y_of(held->origin);
    for (Eigen::Index k = 1; k < r; ++k)
      vectors.col(k) =
          y_of(held->origin + held->directions[static_cast<std::size_t>(k - 1)]) - vectors.col(0);
    vectors.rightCols(n) = Dense::Identity(n, n);
    const Dense basis = orthonormal(vectors, n);
    P.topRows(r) = balanced(basis.leftCols(r)).transpose();
    Dense others = basis.rightCols(n - r);
    if (others.row(0).squaredNorm() > least_share_elsewhere) {
      others = balanced(others);
    } else {
      // From the held place in the directions across it.
      const VectorX nearest = basis.leftCols(r) * basis.row(0).head(r).transpose();
      Dense across = Dense::Zero(n, n - r + r - 1 + n - 1);
      Eigen::Index k = 0;
      for (Eigen::Index d = 1; d < r; ++d) across.col(k++) = vectors.col(d);
      for (Eigen::Index d = 1; d < n; ++d) across.col(k++) = Dense::Identity(n, n).col(d);
      others = orthonormal(across.leftCols(k), n - 1).rightCols(n - r);
      for (Eigen::Index j = 0; j < others.cols(); ++j)
        others.col(j) = nearest / nearest[0] + std::sqrt(static_cast<double>(n - 1)) * others.col(j);
    }
    P.bottomRows(n - r) = others.transpose();
    shape.num_held = static_cast<Index>(r);
  }
  for (Eigen::Index a = 0; a < n; ++a) P.row(a) /= P(a, 0);
  const auto place = [&](Eigen::Index a) {
    Vector3 X = centre;
    X.head(n - 1) += L * P.row(a).tail(n - 1).transpose();
    return X;
  };
  for (Eigen::Index a = 0; a < n; ++a) shape.control_nodes.push_back(place(a));
  if (size_of_cell(shape) < 0) {
    P.row(n - 2).swap(P.row(n - 1));
    std::swap(shape.control_nodes[static_cast<std::size_t>(n - 2)], shape.control_nodes.back());
  }
  VectorX moments(n);
  moments << 1, S;
  const Dense P_inverse = dense::inverse(P);
  shape.masses = shape.mass * (P_inverse.transpose() * moments.asDiagonal() * P_inverse);
  const double rounding = 1e-10 * shape.masses.cwiseAbs().maxCoeff();
  shape.masses = shape.masses.unaryExpr([rounding](double m) { return std::abs(m) > rounding ? m : 0.0; });
}

void refuse_keys(const BodyDescription& body, const RigidDescription& rigid, bool needs_density) {
  const auto refuse = [&](const char* key, const std::string& cure) {
    throw InputError(body.place + "." + key, "none for a rigid body", "one", cure);
  };
  if (!body.regions.empty()) refuse("region", "make the regions bodies of their own");
  if (!body.initial_positions.empty())
    refuse("initial_positions", "place the body with rotate and translate");
  if (!body.initial_velocities.empty()) refuse("initial_velocities", "give velocity and velocity_gradient");
  const DampingDescription& damping = body.damping;
  if (damping.stiffness != 0 || damping.shear_viscosity != 0 || damping.bulk_viscosity != 0)
    refuse("damping", "a rigid body has damping.mass alone");
  const Eigen::Matrix3d& G = body.velocity_gradient;
  if ((G + G.transpose()).norm() > 1e-12 * G.norm())
    throw InputError(body.place + ".velocity_gradient", "a spin for a rigid body (antisymmetric)",
                     "one that stretches it");
  if (needs_density && !rigid.density)
    throw InputError(rigid.place + ".density", "a density for a rigid body with weight or inertia", "none",
                     "rigid = { density = 7800 }");
}

/// The greatest Young's modulus of the deformable bodies [Pa]; 0 where there is none.
double stiffest_modulus(const Description& description) {
  double stiffest = 0;
  for (const BodyDescription& body : description.bodies) {
    if (body.rigid) continue;
    for (const DomainMaterial& material : domain_materials(body, description.dimension)) {
      if (material.region >= 0 && body.regions[static_cast<std::size_t>(material.region)].rigid) continue;
      const std::vector<double>& all = material.constants;
      const std::size_t count = material.law->constants.size();
      for (std::size_t first = 0; first + count <= all.size(); first += count)
        stiffest = std::max(
            stiffest,
            youngs_modulus(*material.law, {all.begin() + static_cast<std::ptrdiff_t>(first),
                                           all.begin() + static_cast<std::ptrdiff_t>(first + count)}));
    }
  }
  return stiffest;
}

/// About the greatest stress of the loads on a body of this extent [Pa].
double stress_of_loads(const Description& description, const BodyDescription& body, double extent) {
  double stress = 0;
  for (const LoadDescription& load : description.loads) {
    if (load.body != body.name && load.body != body.rigid->region_of &&
        !(load.body.empty() && description.bodies.size() == 1))
      continue;
    const int power = load.kind == "body_force"                            ? 1
                      : load.kind == "moment"                              ? -description.dimension
                      : load.kind == "force" || load.kind == "nodal_force" ? 1 - description.dimension
                      : load.kind == "spring"                              ? 2 - description.dimension
                                                                           : 0;
    const double size = load.kind == "spring" ? load.stiffness : load.value.norm() + std::abs(load.pressure);
    stress = std::max(stress, size * std::pow(extent, power));
  }
  return stress;
}

class Maker {
 public:
  Maker(const Description& description, std::vector<std::string>& warnings)
      : description_(description), warnings_(warnings), soft_modulus_(stiffest_modulus(description)) {}

  double soft_modulus() const { return soft_modulus_; }

  std::shared_ptr<const RigidShape> make(const BodyDescription& given, BodyDescription& made) const {
    if (!given.rigid) return nullptr;
    const RigidDescription& rigid = *given.rigid;
    const int dim = description_.dimension;
    refuse_keys(given, rigid,
                description_.is_dynamic || description_.modes || !description_.gravity.isZero(0));
    auto shape = std::make_shared<RigidShape>();
    place_cells(given, *shape);
    const SecondMoments moments =
        second_moments(shape->body.cell_kind, shape->body.cells, shape->rest_positions, dim);
    const double density = rigid.density.value_or(0);
    const double extent = extent_of(*shape);
    shape->mass = density > 0 ? density * moments.size() : 1;  // shares alone without a density
    const Dense second = moments.second().topLeftCorner(dim, dim);
    const dense::Eigenpairs axes = dense::symmetric_eigenpairs(second);
    if (!(axes.values[0] > square(1e-6 * extent)))
      throw InputError(given.place + ".rigid", "a body with a volume", "a flat one");
    const VectorX widths = axes.values.cwiseSqrt();
    const VectorX of_cell = widths.cwiseMax(least_width * widths.maxCoeff());
    const VectorX thinness = widths.cwiseQuotient(of_cell);
    const Dense L = axes.vectors * of_cell.asDiagonal();
    const std::optional<Hull> held = held_place(given, *shape, extent);
    place_control_nodes(held ? &*held : nullptr, moments.mean(), L, thinness.cwiseAbs2(), *shape);
    shape->centre_shares = shape->masses.rowwise().sum() / shape->mass;
    if (density == 0) {
      shape->mass = 0;
      shape->masses.setZero();
    }
    const Moduli moduli = moduli_of(given, rigid, density, extent);
    shape->contact_modulus = moduli.of_contact;
    shape->modulus = moduli.of_stretching;
    shape->has_own_skin = given.skin.has_value();
    shape->region_of = rigid.region_of;
    describe(given, *shape, moduli.of_stretching * thinness.prod(), made);
    return shape;
  }

 private:
  struct Moduli {
    double of_stretching, of_contact;
  };

  static double square(double x) { return x * x; }

  void place_cells(const BodyDescription& given, RigidShape& shape) const {
    const int dim = description_.dimension;
    const CellBlock& cells = solid_cells(given, dim);
    const bool has_simplices = num_corners(cells.kind) == dim + 1;
    BodyDescription linear = given;
    shape.element = find_element(dim, has_simplices, 1, false);
    linear.element = shape.element->name;
    linear.quadrature.clear();
    BodyMesh mesh = make_body_mesh(linear, dim,
                                   {.cells = first_order(cells.kind),
                                    .law = require_law("neo_hookean", given.place),
                                    .poissons_ratio = 0},
                                   warnings_);
    const Placement placement(given);
    for (Vector3& X : mesh.mesh.vertices) {
      X = placement(X);
      if (dim == 2) X.z() = 0;
    }
    shape.mesh = std::move(mesh.mesh);
    shape.rest_positions.resize(static_cast<Eigen::Index>(shape.mesh.vertices.size()) * dim);
    for (std::size_t v = 0; v < shape.mesh.vertices.size(); ++v)
      shape.rest_positions.segment(static_cast<Eigen::Index>(v) * dim, dim) =
          shape.mesh.vertices[v].head(dim);
    Body& body = shape.body;
    body.name = given.name;
    body.element = shape.element->name;
    body.num_nodes = body.num_vertices = static_cast<Index>(shape.mesh.vertices.size());
    body.cell_kind = cell_kind(*shape.element);
    body.cells = std::vector<Index>(shape.mesh.find_solid(dim)->nodes);
  }

  /// The point or the line where supports hold the body.
  std::optional<Hull> held_place(const BodyDescription& given, const RigidShape& shape, double extent) const {
    std::optional<Hull> held;
    for (const FixDescription& fix : description_.fixes) {
      if (fix.body != given.name && !(fix.body.empty() && description_.bodies.size() == 1)) continue;
      const Hull hull = hull_of(shape,
                                select_vertices(fix.where, shape.mesh, shape.body, shape.rest_positions,
                                                description_.dimension, fix.place + ".where"),
                                extent);
      if (static_cast<int>(hull.directions.size()) >= description_.dimension - 1) continue;
      const auto is_in = [extent](const Hull& inner, const Hull& outer) {
        if (!(outer.beside(inner.origin).norm() <= flatness * extent)) return false;
        return std::ranges::all_of(inner.directions, [&](const Vector3& direction) {
          return outer.beside(outer.origin + direction).norm() <= flatness;
        });
      };
      if (held && (hull.directions.size() != held->directions.size() || !is_in(hull, *held)))
        throw InputError(fix.place + ".where",
                         "the same point or line as another [[fix]] of the rigid body \"" + given.name + '"',
                         "another one", "select all held vertices in one [[fix]]");
      held = hull;
    }
    return held;
  }

  Moduli moduli_of(const BodyDescription& given, const RigidDescription& rigid, double density,
                   double extent) const {
    const double weight = density * description_.gravity.head(description_.dimension).norm() * extent;
    const double inertia = description_.is_dynamic ? density * square(extent / description_.time_step) : 0;
    const double stress = std::max(weight, stress_of_loads(description_, given, extent));
    double modulus =
        std::max({over_soft_bodies * soft_modulus_, over_inertia * inertia, over_stresses * stress});
    if (!(modulus > 0)) modulus = 1e9;
    modulus = rigid.stiffness.value_or(modulus);
    double of_contact = soft_modulus_ > 0 ? soft_modulus_ : std::max(inertia, contact_over_stresses * stress);
    if (!(of_contact > 0)) of_contact = modulus / over_stresses;
    return {modulus, of_contact};
  }

  void describe(const BodyDescription& given, const RigidShape& shape, double modulus,
                BodyDescription& made) const {
    const int dim = description_.dimension;
    const CellKind kind = dim == 3 ? CellKind::tetrahedron : CellKind::triangle;
    made.mesh = {};
    made.mesh.vertices = shape.control_nodes;
    made.mesh.block(kind).nodes = dim == 3 ? std::vector<Index>{0, 1, 2, 3} : std::vector<Index>{0, 1, 2};
    made.mesh_name = given.place + ".rigid";
    made.element = find_element(dim, true, 1, false)->name;
    made.quadrature.clear();
    made.contact_shape.clear();
    made.scale = 1;
    made.rotate.reset();
    made.translate.setZero();
    made.mass = MassKind::lumped;
    // The energy of Saint-Venant and Kirchhoff without lateral contraction: E/8 |F^T F - I|^2.
    made.material = {};
    made.material.place = given.place + ".rigid";
    made.material.law = "saint_venant_kirchhoff";
    made.material.constants = {{"youngs_modulus", modulus}, {"poissons_ratio", 0}};
    made.material.density = shape.mass / size_of_cell(shape);
    made.skin.reset();
    made.contact_surface = MeetingSurface::boundary;
    if (shape.is_region()) return;
    SkinDescription skin{.place = given.place + ".rigid", .surface = {}, .surface_name = given.mesh_name};
    if (given.skin) {
      skin = *given.skin;
      skin.is_smooth = false;
      const Placement placement(given);
      for (Vector3& X : skin.surface.vertices) X = placement(X);
    } else {
      skin.surface = extract_surface(shape.mesh).mesh;
    }
    made.skin = std::move(skin);
    made.contact_surface = MeetingSurface::skin;
  }

  const Description& description_;
  std::vector<std::string>& warnings_;
  double soft_modulus_;
};

}  // namespace

bool RigidShape::is_lumped() const { return masses.isDiagonal(0); }

VectorX RigidShape::weights(const Vector3& X) const {
  const auto n = static_cast<Eigen::Index>(control_nodes.size());
  Dense P(n, n);
  VectorX right(n);
  for (Eigen::Index a = 0; a < n; ++a) {
    P(0, a) = 1;
    P.col(a).tail(n - 1) = (control_nodes[static_cast<std::size_t>(a)] - control_nodes[0]).head(n - 1);
  }
  right[0] = 1;
  right.tail(n - 1) = (X - control_nodes[0]).head(n - 1);
  return dense::solve(P, right);
}

CarriedPoints RigidShape::carried_vertices(Index first_node) const {
  const auto n = static_cast<Eigen::Index>(control_nodes.size());
  Dense P(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    P(0, a) = 1;
    P.col(a).tail(n - 1) = (control_nodes[static_cast<std::size_t>(a)] - control_nodes[0]).head(n - 1);
  }
  const Dense inverse = dense::inverse(P);
  CarriedPoints points;
  for (const Vector3& X : mesh.vertices) {
    VectorX right(n);
    right[0] = 1;
    right.tail(n - 1) = (X - control_nodes[0]).head(n - 1);
    const VectorX shares = inverse * right;
    for (Eigen::Index a = 0; a < n; ++a) {
      points.nodes.push_back(first_node + static_cast<Index>(a));
      points.shares.push_back(shares[a]);
    }
    points.end_row();
  }
  return points;
}

std::vector<double> RigidShape::at_vertices(std::span<const double> nodal, int components,
                                            Index first_node) const {
  const CarriedPoints points = carried_vertices(first_node);
  const auto width = static_cast<std::size_t>(components);
  std::vector<double> values(mesh.vertices.size() * width, 0.0);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    points.for_each_node(static_cast<Index>(v), [&](Index node, double share) {
      for (std::size_t k = 0; k < width; ++k)
        values[v * width + k] += share * nodal[static_cast<std::size_t>(node) * width + k];
    });
  return values;
}

std::vector<Index> RigidShape::nodes_held_by(const std::vector<Index>& vertices) const {
  const Hull hull = hull_of(*this, vertices, extent_of(*this));
  const bool holds_all = static_cast<int>(hull.directions.size()) >= dimension() - 1;
  std::vector<Index> nodes;
  for (Index a = 0; a < (holds_all ? static_cast<Index>(control_nodes.size()) : num_held); ++a)
    nodes.push_back(a);
  return nodes;
}

bool RigidShape::is_held_by(std::span<const Vector3> points) const {
  const Hull hull = hull_of(points, dimension(), extent_of(*this));
  return static_cast<int>(hull.directions.size()) >= dimension() - 1;
}

bool is_shown_by_skin(const Body& body) {
  return body.skin != nullptr && (!body.rigid || body.rigid->has_own_skin);
}

bool has_consistent_mass(const Body& body) {
  return body.rigid ? !body.rigid->is_lumped() : body.mass_kind == MassKind::consistent;
}

void add_body_masses(MassMatrix& mass, const Body& body, const VectorX& rest_positions, double factor) {
  if (!body.rigid) {
    for (const Domain& domain : body.domains)
      add_cell_masses(mass, body.domains.element(), domain.cells, rest_positions, factor * domain.density,
                      body.mass_kind == MassKind::consistent);
    return;
  }
  const Dense masses = factor * body.rigid->masses;
  for (Eigen::Index a = 0; a < masses.rows(); ++a) {
    const Index node = body.first_node + static_cast<Index>(a);
    mass.nodal[node] += masses.row(a).sum();
    if (mass.is_lumped()) continue;
    for (Eigen::Index b = a; b < masses.cols(); ++b)
      mass.slots[static_cast<std::size_t>(
          mass.pattern->slot(node, body.first_node + static_cast<Index>(b)))] += masses(a, b);
  }
}

bool has_rigid_bodies(const Description& description) {
  return std::ranges::any_of(description.bodies,
                             [](const BodyDescription& body) { return body.rigid.has_value(); });
}

RigidBodies with_control_nodes(const Description& description, std::vector<std::string>& warnings) {
  check_description(description);
  RigidBodies made{.description = description, .shapes = {}};
  const Maker maker(description, warnings);
  for (BodyDescription& body : made.description.bodies) fill_rigid_regions(body, maker.soft_modulus());
  for (std::size_t b = 0; b < description.bodies.size(); ++b)
    made.shapes.push_back(description.bodies[b].rigid
                              ? maker.make(description.bodies[b], made.description.bodies[b])
                              : nullptr);
  return made;
}

}  // namespace resilin
