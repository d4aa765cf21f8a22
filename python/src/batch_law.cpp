#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "plain_array.hpp"
#include "resilin/core/error.hpp"
#include "resilin/material/batch.hpp"
#include "resilin/material/material_axes.hpp"

namespace resilin::python {
namespace {

// All arrays are C-contiguous and aligned already: the Python layer has seen to
// that.
using Input = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;  // double or float
using Output = nb::ndarray<nb::c_contig, nb::device::cpu>;         // output in the input's type
using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;

void require(bool is_so, const char* what) {
  if (!is_so) throw std::invalid_argument(what);
}

/// A law with its constants and fibres; evaluates arrays of states and writes
/// into arrays of the caller.
class BatchLaw {
 public:
  /// @param constants  in the order of the law; each one number (no axis) or
  /// one for every state
  /// @param fibres     unit vectors, (families, 3) or (count, families, 3)
  BatchLaw(const std::string& law, std::vector<Numbers> constants, std::optional<Numbers> fibres)
      : law_(require_law(law, "law")), constants_(std::move(constants)), fibres_(std::move(fibres)) {
    require(constants_.size() == law_.constants.size(), "one array for each constant");
    for (const Numbers& values : constants_) is_uniform_ = is_uniform_ && values.ndim() == 0;
    if (!fibres_) return;
    is_uniform_ = is_uniform_ && fibres_->ndim() == 2;
    require((fibres_->ndim() == 2 || fibres_->ndim() == 3) && fibres_->shape(fibres_->ndim() - 1) == 3,
            "fibres: (families, 3) or (count, families, 3)");
    refuse_parallel_axes();
  }

  void energy_densities(const Input& F, bool holds_H, const Output& psi) const {
    run(F, holds_H, [&]<class Real>(const StateBatch<Real>& states) {
      resilin::energy_densities(states, written<Real>(psi, states.count));
    });
  }

  void first_piola_kirchhoff_stresses(const Input& F, bool holds_H, const Output& P) const {
    run(F, holds_H, [&]<class Real>(const StateBatch<Real>& states) {
      resilin::first_piola_kirchhoff_stresses(states, written<Real>(P, states.count * entries(states)));
    });
  }

  void stress_tangents(const Input& F, bool holds_H, Projection projection, const Output& A) const {
    run(F, holds_H, [&]<class Real>(const StateBatch<Real>& states) {
      const std::size_t size = states.count * entries(states) * entries(states);
      resilin::stress_tangents(states, projection, written<Real>(A, size));
    });
  }

  void elastic_forces(const Input& F, bool holds_H, const Input& rest_shape_inverses,
                      const Input& rest_volumes, const Output& forces) const {
    run(F, holds_H, [&]<class Real>(const StateBatch<Real>& states) {
      const auto dim = static_cast<std::size_t>(states.dim);
      resilin::elastic_forces(states, read<Real>(rest_shape_inverses, states.count * entries(states)),
                              read<Real>(rest_volumes, states.count),
                              written<Real>(forces, states.count * (dim + 1) * dim));
    });
  }

  // The same at plain arrays into a new one, the short way; none where something else came, or where states
  // have constants of their own.

  nb::object new_energy_densities(nb::handle F, bool holds_H) const {
    return run_plain(F, holds_H, []<class Real>(const StateBatch<Real>& states, const PlainArray& in) {
      const int leading = in.num_axes() - 2;
      if (leading == 0) {
        Real psi = 0;
        resilin::energy_densities(states, &psi);
        return nb::object(numpy().scalar<Real>()(static_cast<double>(psi)));
      }
      return written_into_new<Real>(states.count, Shape(in, leading),
                                    [&](Real* psi) { resilin::energy_densities(states, psi); });
    });
  }

  nb::object new_first_piola_kirchhoff_stresses(nb::handle F, bool holds_H) const {
    return run_plain(F, holds_H, []<class Real>(const StateBatch<Real>& states, const PlainArray& in) {
      return written_into_new<Real>(states.count, Shape(in, in.num_axes()),
                                    [&](Real* P) { resilin::first_piola_kirchhoff_stresses(states, P); });
    });
  }

  nb::object new_elastic_forces(nb::handle F, bool holds_H, nb::handle rest_shape_inverses,
                                nb::handle rest_volumes) const {
    const PlainArray inverses(rest_shape_inverses), volumes(rest_volumes);
    return run_plain(F, holds_H, [&]<class Real>(const StateBatch<Real>& states, const PlainArray& in) {
      const int leading = in.num_axes() - 2;
      if (!inverses.holds<Real>() || !volumes.holds<Real>() || inverses.num_axes() != in.num_axes() ||
          volumes.num_axes() != leading || !inverses.begins_like(in, in.num_axes()) ||
          !volumes.begins_like(in, leading))
        return nb::object(nb::none());
      Shape shape(in, leading);
      shape.with(in.dim() + 1).with(in.dim());
      return written_into_new<Real>(states.count, shape, [&](Real* forces) {
        resilin::elastic_forces(states, inverses.data<const Real>(), volumes.data<const Real>(), forces);
      });
    });
  }

  void constant_derivatives(const Input& F, bool holds_H, std::size_t constant,
                            const std::optional<Output>& dpsi, const std::optional<Output>& dP) const {
    require(constant < constants_.size(), "no such constant");
    run(F, holds_H, [&]<class Real>(const StateBatch<Real>& states) {
      resilin::constant_derivatives(states, constant, dpsi ? written<Real>(*dpsi, states.count) : nullptr,
                                    dP ? written<Real>(*dP, states.count * entries(states)) : nullptr);
    });
  }

  void second_constant_derivatives(const Input& F, bool holds_H, std::size_t p, std::size_t q,
                                   const Output& d2psi) const {
    require(p < constants_.size() && q < constants_.size(), "no such constant");
    run(F, holds_H, [&]<class Real>(const StateBatch<Real>& states) {
      resilin::second_constant_derivatives(states, p, q, written<Real>(d2psi, states.count));
    });
  }

 private:
  void refuse_parallel_axes() const {
    const std::size_t families = fibres_->shape(fibres_->ndim() - 2);
    std::vector<Vector3> directions(families);
    for (std::size_t first = 0; families > 0 && first < fibres_->size(); first += 3 * families) {
      for (std::size_t k = 0; k < families; ++k)
        directions[k] = Eigen::Map<const Vector3>(fibres_->data() + first + 3 * k);
      if (has_parallel_axes(law_, directions))
        throw InputError(std::string(law_.name) + ".fibres", axes_expected, "parallel ones", axes_cure);
    }
  }

  template <class Real>
  static std::size_t entries(const StateBatch<Real>& states) {
    return static_cast<std::size_t>(states.dim * states.dim);
  }

  template <class Real>
  static const Real* read(const Input& array, std::size_t size) {
    require(array.dtype() == nb::dtype<Real>(), "arrays of one type");
    require(array.size() == size, "an input of another size");
    return static_cast<const Real*>(array.data());
  }

  template <class Real>
  static Real* written(const Output& array, std::size_t size) {
    require(array.dtype() == nb::dtype<Real>(), "arrays of one type");
    require(array.size() == size, "an output of another size");
    return static_cast<Real*>(array.data());
  }

  template <class Real>
  StateBatch<Real> states(const Input& F, bool holds_H) const {
    const std::size_t axes = F.ndim();
    require(axes >= 2 && F.shape(axes - 1) == F.shape(axes - 2), "square matrices");
    const std::size_t dim = F.shape(axes - 1);
    require(dim == 2 || dim == 3, "matrices of two or three dimensions");
    return states(static_cast<const Real*>(F.data()), dim, F.size() / (dim * dim), holds_H);
  }

  template <class Real>
  StateBatch<Real> states(const Real* F, std::size_t dim, std::size_t count, bool holds_H) const {
    StateBatch<Real> batch{&law_, static_cast<int>(dim), count, F, holds_H, {}};
    batch.constants.reserve(constants_.size());
    for (const Numbers& values : constants_) {
      const bool is_one = values.ndim() == 0;
      require(is_one || values.size() == count, "one value of each constant for every state");
      batch.constants.push_back({values.data(), is_one ? 0u : 1u});
    }
    if (fibres_) {
      const bool is_one = fibres_->ndim() == 2;
      require(is_one || fibres_->shape(0) == count, "fibres for every state");
      batch.fibres = fibres_->data();
      batch.num_fibres = fibres_->shape(fibres_->ndim() - 2);
      batch.fibre_stride = is_one ? 0 : 3 * batch.num_fibres;
    }
    return batch;
  }

  template <class Function>
  void run(const Input& F, bool holds_H, const Function& function) const {
    const auto run_as = [&]<class Real>(Real) {
      const StateBatch<Real> batch = states<Real>(F, holds_H);
      if (batch.count == 0) return;
      const nb::gil_scoped_release others_run;
      function(batch);
    };
    if (F.dtype() == nb::dtype<double>()) return run_as(double{});
    require(F.dtype() == nb::dtype<float>(), "double or float");
    run_as(float{});
  }

  /// Result of function(states, F), or none.
  template <class Function>
  nb::object run_plain(nb::handle F, bool holds_H, const Function& function) const {
    const PlainArray in(F);
    if (!is_uniform_ || !in.holds_square_matrices()) return nb::none();
    const auto run_as = [&]<class Real>(Real) {
      std::size_t count = 1;
      for (int axis = 0; axis < in.num_axes() - 2; ++axis) count *= static_cast<std::size_t>(in.length(axis));
      return function(states<Real>(in.data<const Real>(), in.dim(), count, holds_H), in);
    };
    if (in.holds<double>()) return run_as(double{});
    return in.holds<float>() ? run_as(float{}) : nb::object(nb::none());
  }

  template <class Real, class Write>
  static nb::object written_into_new(std::size_t count, const Shape& shape, const Write& write) {
    constexpr std::size_t few = 512;  // states that are done before another thread could be woken
    nb::object array = new_array<Real>(shape);
    const PlainArray out(array, true);
    require(out.holds<Real>(), "a new array of another type");
    if (count <= few) {
      write(out.data<Real>());
    } else {
      const nb::gil_scoped_release others_run;
      write(out.data<Real>());
    }
    return array;
  }

  const LawInfo& law_;
  bool is_uniform_ = true;  ///< all states share the constants and the fibres
  std::vector<Numbers> constants_;
  std::optional<Numbers> fibres_;
};

}  // namespace

void bind_batch_law(nb::module_& module) {
  nb::class_<BatchLaw>(module, "BatchLaw")
      .def(nb::init<const std::string&, std::vector<Numbers>, std::optional<Numbers>>(), nb::arg(), nb::arg(),
           nb::arg().none())
      .def("energy_densities", &BatchLaw::energy_densities)
      .def("first_piola_kirchhoff_stresses", &BatchLaw::first_piola_kirchhoff_stresses)
      .def("stress_tangents", &BatchLaw::stress_tangents)
      .def("elastic_forces", &BatchLaw::elastic_forces)
      .def("new_energy_densities", &BatchLaw::new_energy_densities, nb::arg().none(), nb::arg())
      .def("new_first_piola_kirchhoff_stresses", &BatchLaw::new_first_piola_kirchhoff_stresses,
           nb::arg().none(), nb::arg())
      .def("new_elastic_forces", &BatchLaw::new_elastic_forces, nb::arg().none(), nb::arg(), nb::arg().none(),
           nb::arg().none())
      .def("constant_derivatives", &BatchLaw::constant_derivatives)
      .def("second_constant_derivatives", &BatchLaw::second_constant_derivatives);
}

}  // namespace resilin::python
