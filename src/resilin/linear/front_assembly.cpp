#include "resilin/linear/front_assembly.hpp"

#include <algorithm>

#include "resilin/linear/dense_kernels.hpp"

namespace resilin {

void FrontAssembly::add_entries(const Trapezoid& panel) const {
  for (Offset e = analysis.entry_begin[front]; e < analysis.entry_begin[front + 1]; ++e) {
    const MultifrontalAnalysis::Entry& entry = analysis.entries[e];
    const double* block = values.data() + entry.slot * dim * dim;
    const int row = entry.row * dim + (entry.row < supernode().num_columns ? 0 : num_delayed);
    for (int c = 0; c < dim; ++c) {
      double* const to = panel.column(entry.column * dim + c) + row;
      for (int r = 0; r < dim; ++r) to[r] += entry.is_transposed ? block[c * dim + r] : block[r * dim + c];
    }
  }
}

void FrontAssembly::add_to_panel(const Supernode& child, const UpdateMatrix& update, int first_delayed,
                                 const Trapezoid& panel) const {
  const Index* places = analysis.places.data() + child.rows_begin;
  const Index num_child_rows = child.num_rows();
  const auto num_summed =
      static_cast<Index>(std::lower_bound(places, places + num_child_rows, supernode().num_columns) - places);
  for (Index column = 0; column < num_summed; ++column)
    for (int c = 0; c < dim; ++c) {
      const double* from = update.column(update.num_delayed + column * dim + c) + update.num_delayed;
      double* to = panel.column(places[column] * dim + c);
      detail::add_rows(dim, from, places, column, num_summed, to);
      detail::add_rows(dim, from, places, num_summed, num_child_rows, to + num_delayed);
    }
  if (update.num_delayed > 0) add_delayed(child, update, first_delayed, panel);
}

void FrontAssembly::add_delayed(const Supernode& child, const UpdateMatrix& update, int first_delayed,
                                const Trapezoid& panel) const {
  const Index* places = analysis.places.data() + child.rows_begin;
  const int first = num_own() + first_delayed;
  for (int j = 0; j < update.num_delayed; ++j) {
    const double* from = update.column(j);
    double* to = panel.column(first + j);
    for (int i = j; i < update.num_delayed; ++i) to[first + i] += from[i];
    from += update.num_delayed;
    for (Index k = 0; k < child.num_rows(); ++k)
      for (int d = 0; d < dim; ++d) {
        const int place = places[k] * dim + d;
        double& entry = place < num_own() ? panel.column(place)[first + j] : to[place + num_delayed];
        entry += from[k * dim + d];
      }
  }
}

void FrontAssembly::add_to_update(const Supernode& child, const UpdateMatrix& update,
                                  const UpdateMatrix& to) const {
  const Index* places = analysis.places.data() + child.rows_begin;
  const Index num_child_rows = child.num_rows();
  const int shift = to.num_delayed - num_own();  // from places in the front to rows of its update
  const auto first =
      static_cast<Index>(std::lower_bound(places, places + num_child_rows, supernode().num_columns) - places);
  for (Index column = first; column < num_child_rows; ++column)
    for (int c = 0; c < dim; ++c)
      detail::add_rows(dim, update.column(update.num_delayed + column * dim + c) + update.num_delayed, places,
                       column, num_child_rows, to.column(places[column] * dim + c + shift) + shift);
}

}  // namespace resilin
