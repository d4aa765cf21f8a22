#include "resilin/world/mortar.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "resilin/core/error.hpp"
#include "resilin/core/text.hpp"
#include "resilin/mesh/facet.hpp"

namespace resilin {
namespace {

using Point = Eigen::Vector2d;
using Polygon = std::vector<Point>;

constexpr double least_coverage = 0.5;  ///< share of a following facet that must face the other surface
constexpr double least_cosine = 0.1;    ///< between the normals of facets, one turned round
constexpr double negligible_area = 1e-13;
/// Share of the middle of an edge in its ends: Popp, Wohlmuth, Gee & Wall 2012, for faces of six nodes, whose
/// corners have shape functions of mean zero.
constexpr double share_on_triangles = 0.2;
constexpr int degree_of_weights = 6;

double along(const Vector3& a, int k) { return a[k]; }

/// The plane of a facet, or its line in 2D: everything is projected along the normal.
struct Plane {
  Vector3 origin, normal, first, second;

  Plane(int dim, CellKind kind, std::span<const Index> nodes, const VectorX& X) {
    normal = area_vector(dim, kind, nodes, X).normalized();
    origin = node_position(dim, nodes[0], X);
    first = node_position(dim, nodes[1], X) - origin;
    first = (first - normal.dot(first) * normal).normalized();
    second = normal.cross(first);
  }
  Point flat(const Vector3& x) const { return {first.dot(x - origin), second.dot(x - origin)}; }
  double height(const Vector3& x) const { return normal.dot(x - origin); }
};

double area_of(const Polygon& polygon) {
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    area += 0.5 * (a.x() * b.y() - a.y() * b.x());
  }
  return area;
}

/// The part of a polygon within a convex one, both anticlockwise (Sutherland & Hodgman 1974).
Polygon clipped(Polygon polygon, const Polygon& by) {
  for (std::size_t i = 0; i < by.size() && !polygon.empty(); ++i) {
    const Point& from = by[i];
    const Point way = by[(i + 1) % by.size()] - from;
    const auto side = [&](const Point& p) { return way.x() * (p - from).y() - way.y() * (p - from).x(); };
    Polygon left;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Point &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
      const double at_a = side(a), at_b = side(b);
      if (at_a >= 0) left.push_back(a);
      if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0))
        left.push_back(a + at_a / (at_a - at_b) * (b - a));
    }
    polygon = std::move(left);
  }
  return polygon;
}

/// Shape functions of a facet at a point of its projection, given the projections of its corners.
void shape_values(CellKind kind, std::span<const Point> corners, const Point& at, std::span<double> values) {
  if (dimension(kind) == 1) {
    const double s = (at.x() - corners[0].x()) / (corners[1].x() - corners[0].x());
    if (kind == CellKind::line) {
      values[0] = 1 - s;
      values[1] = s;
    } else {
      values[0] = (1 - s) * (1 - 2 * s);
      values[1] = s * (2 * s - 1);
      values[2] = 4 * s * (1 - s);
    }
    return;
  }
  Vector3 xi = Vector3::Zero();
  if (corners.size() == 3) {
    Eigen::Matrix2d sides;
    sides << corners[1] - corners[0], corners[2] - corners[0];
    xi.head<2>() = sides.inverse() * (at - corners[0]);
  } else {
    constexpr int most_iterations = 20;
    xi.head<2>().setConstant(0.5);
    for (int i = 0; i < most_iterations; ++i) {
      const double s = xi.x(), t = xi.y();
      const Point here = (1 - s) * (1 - t) * corners[0] + s * (1 - t) * corners[1] + s * t * corners[2] +
                         (1 - s) * t * corners[3];
      Eigen::Matrix2d slopes;
      slopes << (1 - t) * (corners[1] - corners[0]) + t * (corners[2] - corners[3]),
          (1 - s) * (corners[3] - corners[0]) + s * (corners[2] - corners[1]);
      const Point change = slopes.inverse() * (at - here);
      xi.head<2>() += change;
      if (change.norm() < 1e-15) break;
    }
  }
  element_of_cells(kind)->shape_values(xi, values);
}

struct WeightedPoint {
  Point at;
  double weight;
};

/// Points that integrate over a polygon, in 2D over the interval between its two points.
std::vector<WeightedPoint> points_in(int dim, const Polygon& polygon) {
  std::vector<WeightedPoint> points;
  if (dim == 2) {
    constexpr std::array<std::array<double, 2>, 4> gauss = {{{-0.8611363115940526, 0.3478548451374538},
                                                             {-0.3399810435848563, 0.6521451548625461},
                                                             {0.3399810435848563, 0.6521451548625461},
                                                             {0.8611363115940526, 0.3478548451374538}}};
    const Point half = 0.5 * (polygon[1] - polygon[0]);
    for (const auto& [at, weight] : gauss)
      points.push_back({polygon[0] + (1 + at) * half, weight * std::abs(half.x())});
    return points;
  }
  const QuadratureRule& rule = rule_of_degree(CellShape::triangle, degree_of_weights);
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    const Point a = polygon[k] - polygon[0], b = polygon[k + 1] - polygon[0];
    const double size = a.x() * b.y() - a.y() * b.x();
    for (const QuadraturePoint& point : rule.points)
      points.push_back({polygon[0] + point.xi.x() * a + point.xi.y() * b, point.weight * size});
  }
  return points;
}

/// Boxes around facets, sorted along an axis.
class FacetBoxes {
 public:
  FacetBoxes(int dim, const CellBlock& facets, const VectorX& X) {
    Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (Index f = 0; f < facets.num_cells(); ++f) {
      Box box{f, Vector3::Constant(std::numeric_limits<double>::infinity()), {}};
      box.high = -box.low;
      for (const Index node : facets.cell(f)) {
        box.low = box.low.cwiseMin(node_position(dim, node, X));
        box.high = box.high.cwiseMax(node_position(dim, node, X));
      }
      low = low.cwiseMin(box.low);
      high = high.cwiseMax(box.high);
      boxes_.push_back(box);
    }
    (high - low).maxCoeff(&axis_);
    std::ranges::sort(boxes_, {},
                      [&](const Box& box) { return std::pair(along(box.low, axis_), box.facet); });
    for (const Box& box : boxes_) widest_ = std::max(widest_, along(box.high - box.low, axis_));
  }

  /// The facets whose boxes come as near to the box, in ascending order.
  std::vector<Index> near(const Vector3& low, const Vector3& high, double distance) const {
    std::vector<Index> found;
    const double from = along(low, axis_) - distance - widest_;
    auto box = std::ranges::lower_bound(boxes_, from, {}, [&](const Box& b) { return along(b.low, axis_); });
    for (; box != boxes_.end() && along(box->low, axis_) <= along(high, axis_) + distance; ++box)
      if ((box->low.array() <= high.array() + distance).all() &&
          (box->high.array() >= low.array() - distance).all())
        found.push_back(box->facet);
    std::ranges::sort(found);
    return found;
  }

 private:
  struct Box {
    Index facet;
    Vector3 low, high;
  };
  std::vector<Box> boxes_;
  int axis_ = 0;
  double widest_ = 0;
};

class Mortar {
 public:
  Mortar(int dim, const CellBlock& facets, const CellBlock& leader, const VectorX& X, double max_distance)
      : dim_(dim), facets_(facets), leader_(leader), rest_(X), max_distance_(max_distance) {
    for (const Index node : facets.nodes) row_of_.emplace(node, 0);
    for (auto& [node, row] : row_of_) {
      row = rows_.size();
      rows_.push_back({.node = node});
    }
    of_leader_.resize(rows_.size());
  }

  std::vector<MortarRow> rows(const std::function<bool(Index)>& is_plain, const std::string& place) {
    find_edges(is_plain);
    const FacetBoxes boxes(dim_, leader_, rest_);
    for (Index f = 0; f < facets_.num_cells(); ++f) add_facet(f, boxes, place);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      for (const auto& [node, weight] : of_leader_[i])
        if (weight != 0) rows_[i].of_leader.push_back({node, weight});
      std::ranges::sort(rows_[i].neighbours);
      rows_[i].neighbours.erase(std::ranges::unique(rows_[i].neighbours).begin(), rows_[i].neighbours.end());
    }
    return std::move(rows_);
  }

 private:
  MortarRow& row(Index node) { return rows_[row_of_.at(node)]; }

  void find_edges(const std::function<bool(Index)>& is_plain) {
    for (Index f = 0; f < facets_.num_cells(); ++f) {
      const std::span<const Index> nodes = facets_.cell(f);
      for (const Index node : nodes)
        for (const Index other : nodes)
          if (other != node) row(node).neighbours.push_back(other);
      if (facets_.kind != CellKind::triangle6) continue;
      for (std::size_t e = 0; e < 3; ++e) {
        MortarRow& middle = row(nodes[3 + e]);
        middle.ends = {nodes[e], nodes[(e + 1) % 3]};
        middle.share_of_ends = is_plain(middle.node) ? 0 : share_on_triangles;
      }
    }
  }

  Polygon flat_corners(const Plane& plane, const CellBlock& block, Index facet) const {
    Polygon corners;
    for (int k = 0; k < num_corners(block.kind); ++k)
      corners.push_back(
          plane.flat(node_position(dim_, block.cell(facet)[static_cast<std::size_t>(k)], rest_)));
    return corners;
  }

  /// Where the projections overlap; empty where they do not.
  Polygon overlap(const Polygon& own, const Polygon& other) const {
    if (dim_ == 3) {
      Polygon turned(other.rbegin(), other.rend());  // it faces the other way
      return clipped(own, turned);
    }
    const double from = std::max(own[0].x(), std::min(other[0].x(), other[1].x()));
    const double to = std::min(own[1].x(), std::max(other[0].x(), other[1].x()));
    if (!(from < to)) return {};
    return {{from, 0}, {to, 0}};
  }

  double size_of(const Polygon& polygon) const {
    if (polygon.empty()) return 0;
    return dim_ == 3 ? area_of(polygon) : polygon[1].x() - polygon[0].x();
  }

  void add_facet(Index f, const FacetBoxes& boxes, const std::string& place) {
    const std::span<const Index> nodes = facets_.cell(f);
    const auto n = static_cast<Eigen::Index>(nodes.size());
    const Plane plane(dim_, facets_.kind, nodes, rest_);
    const Polygon own = flat_corners(plane, facets_, f);
    Vector3 low = node_position(dim_, nodes[0], rest_), high = low;
    for (const Index node : nodes) {
      low = low.cwiseMin(node_position(dim_, node, rest_));
      high = high.cwiseMax(node_position(dim_, node, rest_));
    }
    // Shape functions of corners take the middles of their edges along.
    Eigen::MatrixXd taken = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index e = 3; e < n && facets_.kind == CellKind::triangle6; ++e) {
      const double share = row(nodes[static_cast<std::size_t>(e)]).share_of_ends;
      taken(e, e) = 1 - 2 * share;
      taken(e - 3, e) = taken((e - 2) % 3, e) = share;
    }
    Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd sizes = Eigen::VectorXd::Zero(n), values(n), leader_values;
    std::vector<std::pair<Index, Eigen::MatrixXd>> couplings;
    double covered = 0;
    const double whole = size_of(own);
    for (const Index other : boxes.near(low, high, max_distance_)) {
      const std::span<const Index> leaders = leader_.cell(other);
      if (!(area_vector(dim_, leader_.kind, leaders, rest_).normalized().dot(plane.normal) < -least_cosine))
        continue;
      const Polygon corners = flat_corners(plane, leader_, other);
      const Polygon both = overlap(own, corners);
      const double size = size_of(both);
      if (!(size > negligible_area * whole)) continue;
      const auto m = static_cast<Eigen::Index>(leaders.size());
      leader_values.resize(m);
      Eigen::MatrixXd coupling = Eigen::MatrixXd::Zero(n, m);
      double distance = 0;
      for (const WeightedPoint& point : points_in(dim_, both)) {
        shape_values(facets_.kind, own, point.at, {values.data(), static_cast<std::size_t>(n)});
        shape_values(leader_.kind, corners, point.at, {leader_values.data(), static_cast<std::size_t>(m)});
        double height = 0;
        for (Eigen::Index k = 0; k < m; ++k)
          height += leader_values[k] *
                    plane.height(node_position(dim_, leaders[static_cast<std::size_t>(k)], rest_));
        distance = std::max(distance, std::abs(height));
        const Eigen::VectorXd own_values = taken * values;
        mass += point.weight * own_values * own_values.transpose();
        sizes += point.weight * own_values;
        coupling += point.weight * own_values * leader_values.transpose();
      }
      if (distance > max_distance_) throw apart(place, distance, nodes);
      covered += size;
      couplings.emplace_back(other, std::move(coupling));
    }
    if (!(covered >= least_coverage * whole)) {
      const double distance = nearest_beyond_reach(plane, own);
      if (covered == 0 && std::isfinite(distance)) throw apart(place, distance, nodes);
      throw InputError(place, "a surface that lies on the other one",
                       "a facet near " + place_of(nodes) + " of which " +
                           format_short(100 * (1 - covered / whole)) + " % face nothing within " +
                           format_short(max_distance_) + " m",
                       "select less, raise max_distance, or let the other surface follow");
    }
    if (covered > 1.001 * whole) {
      throw InputError(place, "one surface opposite",
                       "several facets opposite each other near " + place_of(nodes),
                       "select the side that is meant with `where`, or lower max_distance");
    }
    const Eigen::MatrixXd dual = sizes.asDiagonal() * mass.inverse();
    for (Eigen::Index a = 0; a < n; ++a) row(nodes[static_cast<std::size_t>(a)]).own += sizes[a];
    for (const auto& [other, coupling] : couplings) {
      const Eigen::MatrixXd weights = dual * coupling;
      const std::span<const Index> leaders = leader_.cell(other);
      for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index k = 0; k < weights.cols(); ++k)
          of_leader_[row_of_.at(nodes[static_cast<std::size_t>(a)])][leaders[static_cast<std::size_t>(k)]] +=
              weights(a, k);
    }
  }

  InputError apart(const std::string& place, double distance, std::span<const Index> nodes) const {
    return InputError(place, "surfaces that are at most " + format_short(max_distance_) + " m apart",
                      format_short(distance) + " m near " + place_of(nodes),
                      "raise max_distance, or select the parts that meet");
  }

  /// Distance of the nearest facet that faces this one from farther than the tie reaches [m]; infinite: none.
  double nearest_beyond_reach(const Plane& plane, const Polygon& own) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (Index other = 0; other < leader_.num_cells(); ++other) {
      const std::span<const Index> leaders = leader_.cell(other);
      if (!(area_vector(dim_, leader_.kind, leaders, rest_).normalized().dot(plane.normal) < -least_cosine))
        continue;
      const Polygon corners = flat_corners(plane, leader_, other);
      if (!(size_of(overlap(own, corners)) > negligible_area * size_of(own))) continue;
      double distance = 0;
      for (std::size_t k = 0; k < corners.size(); ++k)
        distance += std::abs(plane.height(node_position(dim_, leaders[k], rest_))) /
                    static_cast<double>(corners.size());
      if (distance > max_distance_) nearest = std::min(nearest, distance);
    }
    return nearest;
  }

  std::string place_of(std::span<const Index> nodes) const {
    Vector3 middle = Vector3::Zero();
    for (const Index node : nodes)
      middle += node_position(dim_, node, rest_) / static_cast<double>(nodes.size());
    std::string text = "(" + format_short(middle.x()) + ", " + format_short(middle.y());
    return text + (dim_ == 3 ? ", " + format_short(middle.z()) : "") + ")";
  }

  int dim_;
  const CellBlock& facets_;
  const CellBlock& leader_;
  const VectorX& rest_;
  double max_distance_;
  std::map<Index, std::size_t> row_of_;
  std::vector<MortarRow> rows_;
  std::vector<std::map<Index, double>> of_leader_;
};

}  // namespace

std::vector<MortarRow> mortar_rows(int dim, const CellBlock& facets, const CellBlock& leader,
                                   const VectorX& rest_positions, double max_distance,
                                   const std::function<bool(Index)>& is_plain, const std::string& place) {
  return Mortar(dim, facets, leader, rest_positions, max_distance).rows(is_plain, place);
}

double mean_size(int dim, const CellBlock& facets, const VectorX& rest_positions) {
  double sum = 0;
  for (Index f = 0; f < facets.num_cells(); ++f)
    sum += area_vector(dim, facets.kind, facets.cell(f), rest_positions).norm();
  const double mean = sum / facets.num_cells();
  return dim == 3 ? std::sqrt(mean) : mean;
}

}  // namespace resilin
