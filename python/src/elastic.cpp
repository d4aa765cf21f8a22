#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "bindings.hpp"
#include "csr.hpp"
#include "resilin/element/catalog.hpp"
#include "resilin/energy/elastic.hpp"
#include "resilin/energy/mass.hpp"
#include "resilin/mesh/cell_positions.hpp"

namespace resilin::python {
namespace {

/// An elastic body by itself with the pattern of its Hessian.
class ElasticBody {
 public:
  /// @param constants  (1, C), or a row for each cell
  /// @param fibres     directions (K, 3), each family once or for one cell after another; none: (0, 3)
  ElasticBody(int dim, const std::string& element, const std::string& quadrature,
              const Array2d<double>& positions, const Array2d<Index>& cells, const std::string& law,
              const Array2d<double>& constants, const Array2d<double>& fibres, std::size_t num_families)
      : dim_(dim),
        cells_(cells.data(), cells.data() + cells.size()),
        rest_positions_(unknowns(positions)),
        energy_(dim, ElementChoice(element, quadrature), cells_, rest_positions_,
                require_law(law, "material.law"), std::span(constants.data(), constants.size()),
                {vectors(fibres), num_families}) {
    BlockPatternBuilder builder(static_cast<Index>(rest_positions_.size() / dim));
    energy_.add_pattern(builder);
    pattern_ = std::make_shared<const BlockPattern>(builder.build());
    energy_.bind(*pattern_);
  }

  double value(const Array2d<double>& x) const {
    const VectorX at = unknowns(x);
    const nb::gil_scoped_release release;
    return energy_.value(at, {});
  }

  NumpyArray<double> gradient(const Array2d<double>& x) const {
    const VectorX at = unknowns(x);
    VectorX gradient = VectorX::Zero(at.size());
    {
      const nb::gil_scoped_release release;
      energy_.add_gradient(at, {}, gradient);
    }
    return node_array(gradient, dim_);
  }

  CsrArrays hessian(const Array2d<double>& x, Projection projection) const {
    const VectorX at = unknowns(x);
    Csr csr;
    {
      const nb::gil_scoped_release release;
      BlockMatrix matrix(dim_, pattern_);
      energy_.add_hessian(at, {}, projection, matrix);
      csr = to_csr(matrix);
    }
    return arrays_of(std::move(csr));
  }

  CsrArrays mass(double density, bool is_consistent) const {
    Csr csr;
    {
      const nb::gil_scoped_release release;
      MassMatrix mass{
          .dim = dim_, .nodal = VectorX::Zero(pattern_->num_nodes()), .pattern = nullptr, .slots = {}};
      if (is_consistent) {
        mass.pattern = pattern_;
        mass.slots.assign(static_cast<std::size_t>(pattern_->num_slots()), 0.0);
      }
      add_cell_masses(mass, energy_.element(), cells_, rest_positions_, density, is_consistent);
      BlockMatrix matrix(dim_, pattern_);
      mass.add_to(1, matrix);
      csr = to_csr(matrix);
    }
    return arrays_of(std::move(csr));
  }

  double max_step(const Array2d<double>& x, const Array2d<double>& p) const {
    const VectorX at = unknowns(x), direction = unknowns(p);
    const nb::gil_scoped_release release;
    return energy_.max_step(at, direction, {});
  }

  NumpyArray<double> rest_volumes() const { return cell_array(energy_.rest_volumes()); }
  NumpyArray<double> point_volumes() const { return cell_array(energy_.point_volumes()); }
  std::size_t num_points() const { return static_cast<std::size_t>(energy_.num_points()); }
  std::string quadrature() const { return std::string(energy_.quadrature().name); }
  bool has_mean_volume() const { return energy_.element().has_mean_volume; }

  /// dN_a/dX_k at each quadrature point [1/m]: (M Q, nodes of a cell, dim)
  NumpyArray<double> shape_gradients() const {
    const ElementInfo& element = energy_.element();
    const auto n = static_cast<std::size_t>(element.num_nodes), dim = static_cast<std::size_t>(dim_);
    const QuadratureRule& rule = energy_.quadrature();
    const std::size_t count = cells_.size() / n * rule.points.size();
    std::vector<double> all, X;
    all.reserve(count * n * dim);
    {
      const nb::gil_scoped_release release;
      for (std::size_t first = 0; first < cells_.size(); first += n) {
        cell_positions(dim_, std::span(cells_).subspan(first, n), rest_positions_, X);
        for (const QuadraturePoint& point : rule.points) {
          const PointGeometry geometry = point_geometry(element, point, X);
          all.insert(all.end(), geometry.gradients.begin(), geometry.gradients.end());
        }
      }
    }
    return numpy_array(std::move(all), {count, n, dim});
  }
  NumpyArray<double> volume_ratios(const Array2d<double>& x) const {
    return by_point(x, &ElasticEnergy::volume_ratios);
  }
  NumpyArray<double> energy_densities(const Array2d<double>& x) const {
    return by_point(x, &ElasticEnergy::energy_densities);
  }
  NumpyArray<double> von_mises_stresses(const Array2d<double>& x) const {
    return by_point(x, &ElasticEnergy::von_mises_stresses);
  }
  NumpyArray<double> cauchy_stresses(const Array2d<double>& x) const {
    return tensors_by_point(x, &ElasticEnergy::cauchy_stresses);
  }
  NumpyArray<double> deformation_gradients(const Array2d<double>& x) const {
    return tensors_by_point(x, &ElasticEnergy::deformation_gradients);
  }

 private:
  static NumpyArray<double> cell_array(std::vector<double> values) {
    const std::size_t count = values.size();
    return numpy_array(std::move(values), {count});
  }

  NumpyArray<double> by_point(const Array2d<double>& x,
                              std::vector<double> (ElasticEnergy::*quantity)(const VectorX&) const) const {
    const VectorX at = unknowns(x);
    std::vector<double> values;
    {
      const nb::gil_scoped_release release;
      values = (energy_.*quantity)(at);
    }
    return cell_array(std::move(values));
  }

  /// (M Q, 3, 3), Q quadrature points in a cell
  NumpyArray<double> tensors_by_point(const Array2d<double>& x,
                                      std::vector<Matrix<3>> (ElasticEnergy::*quantity)(const VectorX&)
                                          const) const {
    const VectorX at = unknowns(x);
    std::vector<double> values;
    {
      const nb::gil_scoped_release release;
      for (const Matrix<3>& tensor : (energy_.*quantity)(at))
        for (Eigen::Index i = 0; i < 3; ++i)
          for (Eigen::Index j = 0; j < 3; ++j) values.push_back(tensor(i, j));
    }
    const std::size_t count = values.size() / 9;
    return numpy_array(std::move(values), {count, 3, 3});
  }

  int dim_;
  std::vector<Index> cells_;
  VectorX rest_positions_;
  ElasticEnergy energy_;
  std::shared_ptr<const BlockPattern> pattern_;
};

}  // namespace

void bind_elastic(nb::module_& module) {
  nb::class_<ElasticBody>(module, "ElasticBody")
      .def(
          nb::init<int, const std::string&, const std::string&, const Array2d<double>&, const Array2d<Index>&,
                   const std::string&, const Array2d<double>&, const Array2d<double>&, std::size_t>(),
          nb::arg("dim"), nb::arg("element"), nb::arg("quadrature"), nb::arg("positions"), nb::arg("cells"),
          nb::arg("law"), nb::arg("constants"), nb::arg("fibres"), nb::arg("num_families"))
      .def("value", &ElasticBody::value, nb::arg("x"))
      .def("gradient", &ElasticBody::gradient, nb::arg("x"))
      .def("hessian", &ElasticBody::hessian, nb::arg("x"), nb::arg("projection"))
      .def("mass", &ElasticBody::mass, nb::arg("density"), nb::arg("is_consistent"))
      .def("max_step", &ElasticBody::max_step, nb::arg("x"), nb::arg("p"))
      .def("rest_volumes", &ElasticBody::rest_volumes)
      .def("point_volumes", &ElasticBody::point_volumes)
      .def("shape_gradients", &ElasticBody::shape_gradients)
      .def_prop_ro("num_points", &ElasticBody::num_points)
      .def_prop_ro("has_mean_volume", &ElasticBody::has_mean_volume)
      .def_prop_ro("quadrature", &ElasticBody::quadrature)
      .def("volume_ratios", &ElasticBody::volume_ratios, nb::arg("x"))
      .def("energy_densities", &ElasticBody::energy_densities, nb::arg("x"))
      .def("von_mises_stresses", &ElasticBody::von_mises_stresses, nb::arg("x"))
      .def("cauchy_stresses", &ElasticBody::cauchy_stresses, nb::arg("x"))
      .def("deformation_gradients", &ElasticBody::deformation_gradients, nb::arg("x"));
}

}  // namespace resilin::python
