#include "resilin/contact/term_sums.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "resilin/collision/feature.hpp"
#include "resilin/contact/pair_barrier.hpp"
#include "resilin/core/parallel.hpp"

namespace resilin {
namespace {

constexpr std::size_t terms_per_chunk = 64;
/// Terms whose vectors or matrices wait at the same time to be added.
constexpr std::size_t terms_at_once = 256;

/// Where the vertices of a term are.
template <int dim>
class TermPlaces {
 public:
  TermPlaces(const ContactTerm& term, const VectorX& all) : count_(term.used_vertices().size()) {
    std::size_t k = 0;
    for (const Index v : term.used_vertices()) corners_[k++] = all.segment<dim>(Eigen::Index{v} * dim);
  }
  operator std::span<const Vector<dim>>() const { return std::span(corners_).first(count_); }

 private:
  std::array<Vector<dim>, most_pair_vertices> corners_;
  std::size_t count_;
};

template <int dim>
PairBarrier<dim> barrier_of(const ContactTerm& term, const VectorX& places) {
  return {term.barrier(), term.kind, TermPlaces<dim>(term, places), term.stiffness, term.mollifier()};
}

template <class Visit>
auto in_dimension(const TermSet& set, const Visit& visit) {
  return set.surface.parts.dim == 3 ? visit(std::integral_constant<int, 3>())
                                    : visit(std::integral_constant<int, 2>());
}

/// Evaluates terms in parallel and takes the results in their order.
template <class Result, class Evaluate, class Take>
void for_each_term(std::span<const ContactTerm> terms, const Evaluate& evaluate, const Take& take) {
  std::vector<Result> results(std::min(terms.size(), terms_at_once));
  for (std::size_t first = 0; first < terms.size(); first += terms_at_once) {
    const std::span<const ContactTerm> some =
        terms.subspan(first, std::min(terms_at_once, terms.size() - first));
    parallel_for(some.size(), terms_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) evaluate(some[k], results[k]);
    });
    for (std::size_t k = 0; k < some.size(); ++k) take(some[k], results[k]);
  }
}

/// Adds a term to those of one point.
void add_merged(Feature feature, const ContactTerm& term, std::size_t first,
                std::vector<ContactTerm>& merged) {
  if (feature.vertices[0] != term.vertices[0]) std::swap(feature.vertices[0], feature.vertices[1]);
  for (std::size_t k = first; k < merged.size(); ++k)
    if (merged[k].kind == feature.kind && merged[k].vertices == feature.vertices) {
      merged[k].stiffness += term.stiffness;
      return;
    }
  merged.push_back(
      {feature.kind, feature.vertices, term.stiffness, 0, term.activation_distance, term.radius});
}

template <int dim>
ContactTerms merged_in(const ContactTerms& all, const VectorX& places) {
  ContactTerms merged;
  std::size_t point = 0, next = 0;
  const std::span<const ContactTerm> of_points = std::span(all.terms).first(all.point_begin.back());
  for_each_term<std::optional<Feature>>(
      of_points,
      [&](const ContactTerm& term, std::optional<Feature>& feature) {
        const PairDistance<dim> pair = pair_distance<dim>(term.kind, TermPlaces<dim>(term, places));
        feature.reset();
        if (!(pair.distance >= term.barrier().reach()))
          feature = closest_feature(term.kind, term.used_vertices(), pair.weights);
      },
      [&](const ContactTerm& term, const std::optional<Feature>& feature) {
        if (feature) add_merged(*feature, term, merged.point_begin.back(), merged.terms);
        if (++next < all.point_begin[point + 1]) return;
        const auto first = merged.terms.begin() + static_cast<std::ptrdiff_t>(merged.point_begin.back());
        merged.terms.erase(std::remove_if(first, merged.terms.end(),
                                          [](const ContactTerm& sum) { return sum.stiffness == 0; }),
                           merged.terms.end());
        merged.point_begin.push_back(merged.terms.size());
        ++point;
      });
  const std::span<const ContactTerm> edges = all.of_edges();
  merged.terms.insert(merged.terms.end(), edges.begin(), edges.end());
  return merged;
}

/// Adds the matrix of a term to the nodes that its vertices follow.
template <int dim>
void add_to_nodes(const ContactSurface& surface, const ContactTerm& term, const PairMatrix<dim>& matrix,
                  BlockMatrix& hessian) {
  using Block = Eigen::Matrix<double, dim, dim, Eigen::RowMajor>;
  const std::span<const Index> vertices = term.used_vertices();
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t j = i; j < vertices.size(); ++j) {
      const Block block = matrix.template block<dim, dim>(static_cast<Eigen::Index>(i) * dim,
                                                          static_cast<Eigen::Index>(j) * dim);
      surface.vertices.for_each_pair_of_nodes(vertices[i], vertices[j], [&](Index a, Index b, double share) {
        if (i == j && a > b) return;  // the other half of the matrix
        Block part = share * block;
        if (i != j && a == b) part += part.transpose().eval();
        hessian.add_block(a, b, part.data());
      });
    }
}

}  // namespace

double sum_of_values(const TermSet& set, const VectorX& places) {
  return in_dimension(set, [&](auto dim) {
    return parallel_sum<double>(set.terms.size(), terms_per_chunk, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t k = begin; k < end; ++k) sum += barrier_of<dim>(set.terms[k], places).value();
      return sum;
    });
  });
}

double sum_of_differences(const TermSet& set, const VectorX& from, const VectorX& to) {
  return in_dimension(set, [&](auto dim) {
    return parallel_sum<double>(set.terms.size(), terms_per_chunk, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t k = begin; k < end; ++k) {
        const ContactTerm& term = set.terms[k];
        sum += pair_barrier_difference<dim>(term.barrier(), term.kind, TermPlaces<dim>(term, from),
                                            TermPlaces<dim>(term, to), term.stiffness, term.mollifier());
      }
      return sum;
    });
  });
}

VectorX sum_of_gradients(const TermSet& set, const VectorX& places, GradientParts parts) {
  VectorX sum = VectorX::Zero(places.size());
  in_dimension(set, [&](auto dim) {
    for_each_term<PairVector<dim>>(
        set.terms,
        [&](const ContactTerm& term, PairVector<dim>& gradient) {
          gradient = barrier_of<dim>(term, places).gradient();
          if (parts == GradientParts::magnitudes) gradient = gradient.cwiseAbs().eval();
        },
        [&](const ContactTerm& term, const PairVector<dim>& gradient) {
          Eigen::Index k = 0;
          for (const Index v : term.used_vertices())
            sum.segment<dim>(Eigen::Index{v} * dim) += gradient.template segment<dim>(dim * k++);
        });
  });
  return sum;
}

std::vector<double> slopes_along(const TermSet& set, const VectorX& places, const VectorX& along) {
  std::vector<double> slopes(set.terms.size());
  in_dimension(set, [&](auto dim) {
    parallel_for(slopes.size(), terms_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const ContactTerm& term = set.terms[k];
        const PairVector<dim> gradient = barrier_of<dim>(term, places).gradient();
        double sum = 0;
        Eigen::Index corner = 0;
        for (const Index v : term.used_vertices())
          sum +=
              gradient.template segment<dim>(dim * corner++).dot(along.segment<dim>(Eigen::Index{v} * dim));
        slopes[k] = sum;
      }
    });
  });
  return slopes;
}

void add_node_hessian(const TermSet& set, const VectorX& places, double weight, Projection projection,
                      BlockMatrix& hessian) {
  in_dimension(set, [&](auto dim) {
    for_each_term<PairMatrix<dim>>(
        set.terms,
        [&](const ContactTerm& term, PairMatrix<dim>& matrix) {
          matrix = weight * barrier_of<dim>(term, places).hessian(projection);
        },
        [&](const ContactTerm& term, const PairMatrix<dim>& matrix) {
          add_to_nodes<dim>(set.surface, term, matrix, hessian);
        });
  });
}

std::vector<PartForce> part_forces(const TermSet& set, const VectorX& places) {
  std::vector<PartForce> forces;
  in_dimension(set, [&](auto dim) {
    for_each_term<std::optional<PartForce>>(
        set.terms,
        [&](const ContactTerm& term, std::optional<PartForce>& force) {
          force.reset();
          const PairBarrier<dim> pair = barrier_of<dim>(term, places);
          if (!pair.is_active()) return;
          Vector3 normal = Vector3::Zero();
          normal.head<dim>() = pair.distance().normal;
          force = PartForce{
              term.kind,          term.vertices, pair.distance().weights, normal, pair.distance().distance,
              pair.normal_force()};
        },
        [&](const ContactTerm&, const std::optional<PartForce>& force) {
          if (force) forces.push_back(*force);
        });
  });
  return forces;
}

namespace {

/// With f = -k m b', dd = sum_i w_i n.dx_i, and of tangents e_a the free ones first, q_a = sum_i w_i
/// e_a.dx_i, p_a = sum_i v_ai n.dx_i:
///
///   dn = sum_(a not free) e_a q_a / d - sum_(a free) e_a p_a,   dw_i = -sum_(a free) v_ai (q_a + d p_a)
///
/// (from Hess d, see PairDistance).
template <int dim>
PartForceSlopes slopes_of(const ContactTerm& term, std::size_t number, const VectorX& places) {
  PartForceSlopes slopes{.term = number, .force = {}, .normal = {}, .weights = {}};
  const PairBarrier<dim> pair = barrier_of<dim>(term, places);
  const PairDistance<dim>& at = pair.distance();
  const auto in_space = [](const Vector<dim>& v) {
    Vector3 all = Vector3::Zero();
    all.template head<dim>() = v;
    return all;
  };
  const PairVector<dim> of_force = pair.normal_force_gradient();
  const Vector3 n = in_space(at.normal);
  for (std::size_t k = 0; k < most_pair_vertices; ++k) {
    slopes.force[k] = in_space(of_force.template segment<dim>(static_cast<Eigen::Index>(k) * dim));
    slopes.normal[k].setZero();
    for (Vector3& slope : slopes.weights[k]) slope.setZero();
  }
  for (int a = 0; a < dim - 1; ++a) {
    const Vector3 e = in_space(at.tangents[static_cast<std::size_t>(a)]);
    const auto& v = at.weight_slopes[static_cast<std::size_t>(a)];
    for (std::size_t k = 0; k < most_pair_vertices; ++k) {
      if (a >= at.num_free) {
        slopes.normal[k] += at.weights[k] / at.distance * e * e.transpose();
        continue;
      }
      slopes.normal[k] -= v[k] * e * n.transpose();
      for (std::size_t i = 0; i < most_pair_vertices; ++i)
        slopes.weights[i][k] -= v[i] * (at.weights[k] * e + at.distance * v[k] * n);
    }
  }
  return slopes;
}

}  // namespace

std::vector<PartForceSlopes> part_force_slopes(const TermSet& set, const VectorX& places) {
  std::vector<PartForceSlopes> all;
  in_dimension(set, [&](auto dim) {
    for (std::size_t k = 0; k < set.terms.size(); ++k)
      if (barrier_of<dim>(set.terms[k], places).is_active())
        all.push_back(slopes_of<dim>(set.terms[k], k, places));
  });
  return all;
}

VectorX hessian_times(const TermSet& set, const VectorX& places, const VectorX& displacements) {
  VectorX sum = VectorX::Zero(places.size());
  in_dimension(set, [&](auto dim) {
    for_each_term<PairVector<dim>>(
        set.terms,
        [&](const ContactTerm& term, PairVector<dim>& product) {
          PairVector<dim> way = PairVector<dim>::Zero();
          Eigen::Index k = 0;
          for (const Index v : term.used_vertices())
            way.template segment<dim>(dim * k++) = displacements.segment<dim>(Eigen::Index{v} * dim);
          product = barrier_of<dim>(term, places).hessian(Projection::none) * way;
        },
        [&](const ContactTerm& term, const PairVector<dim>& product) {
          Eigen::Index k = 0;
          for (const Index v : term.used_vertices())
            sum.segment<dim>(Eigen::Index{v} * dim) += product.template segment<dim>(dim * k++);
        });
  });
  return sum;
}

ContactTerms merged_terms(const ContactSurface& surface, const ContactTerms& terms, const VectorX& places) {
  return surface.parts.dim == 3 ? merged_in<3>(terms, places) : merged_in<2>(terms, places);
}

}  // namespace resilin
