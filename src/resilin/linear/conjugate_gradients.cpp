#include "resilin/linear/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>

#include "resilin/core/memory.hpp"
#include "resilin/core/parallel.hpp"
#include "resilin/linear/kernels/block_kernels.hpp"

namespace resilin {
namespace {

constexpr std::size_t numbers_per_chunk = 1 << 13;
/// A matrix that has changed by no more than this share of its diagonals is served by the preconditioner of
/// the one before: at 0.1 a bar under load took a quarter more iterations, at 0.03 as many as before.
constexpr double near_enough = 0.03;
/// Vectors of larger systems cost little beside a solve to be made anew, and much to be held between them.
constexpr Eigen::Index most_kept_unknowns = 1 << 16;

/// The node that contributes most to a negative curvature p^T A p.
Index most_negative_node(const VectorX& p, const VectorX& Ap, int dim) {
  Index worst = -1;
  double lowest = 0;
  for (Index node = 0; node < p.size() / dim; ++node) {
    const double part = p.segment(node * dim, dim).dot(Ap.segment(node * dim, dim));
    if (part < lowest) {
      lowest = part;
      worst = node;
    }
  }
  return worst;
}

}  // namespace

void ConjugateGradients::foresee(const BlockMatrix& A) {
  if (foreseen_ == A.pattern) return;
  const double bytes = expected_bytes(*A.pattern, A.dim);
  if (!fits(bytes))
    foresee_memory(
        bytes, "solver.kind = \"" + name_ + "\" for " + std::to_string(A.num_unknowns()) + " DOFs",
        what_would_fit(A.num_unknowns(), bytes, "DOFs") + ": take fewer cells, or raise the limit");
  foreseen_ = A.pattern;
}

void ConjugateGradients::analyze(const BlockMatrix& A, const VectorX& node_positions) {
  try {
    foresee(A);
  } catch (const OutOfMemory&) {
    return;  // `factorize` says it
  }
  if (!factorized_.is_near(A, near_enough)) preconditioner_->analyze(A, node_positions);
}

LinearReport ConjugateGradients::factorize(const BlockMatrix& A) {
  LinearReport report;
  try {
    foresee(A);
    if (factorized_.is_near(A, near_enough)) return report;
    factorized_.forget();
    report = preconditioner_->factorize(A);
    if (report.status == LinearReport::Status::ok) factorized_.take(A);
    iterations_per_digit_ = 0;
    return report;
  } catch (const OutOfMemory& shortage) {
    report.shortage = shortage.what();
  }
  report.status = LinearReport::Status::out_of_memory;
  return report;
}

/// One that has become worse for a later matrix than it was for its own is not kept any longer.
void ConjugateGradients::judge_preconditioner(int iterations, double relative_tolerance) {
  constexpr double much_worse = 1.5, few = 2;
  const double per_digit = iterations / std::max(1.0, -std::log10(relative_tolerance));
  if (iterations_per_digit_ == 0) {
    iterations_per_digit_ = per_digit;
  } else if (per_digit > much_worse * iterations_per_digit_ + few) {
    factorized_.forget();
  }
}

LinearReport ConjugateGradients::solve(const BlockMatrix& A, const VectorX& b, VectorX& x,
                                       double relative_tolerance) {
  const LinearReport report = iterate(A, b, x, relative_tolerance);
  if (b.size() > most_kept_unknowns) vectors_ = {};
  return report;
}

LinearReport ConjugateGradients::iterate(const BlockMatrix& A, const VectorX& b, VectorX& x,
                                         double relative_tolerance) {
  auto& [r, p, image, work] = vectors_;
  const detail::BlockKernels& kernels = detail::block_kernels();
  const auto n = static_cast<std::size_t>(b.size());
  const auto dot = [&](const VectorX& u, const VectorX& v) {
    return parallel_sum<double>(n, numbers_per_chunk, [&](std::size_t begin, std::size_t end) {
      return kernels.dot(u.data() + begin, v.data() + begin, static_cast<Offset>(end - begin));
    });
  };
  LinearReport report;
  if (x.size() != b.size()) x.setZero(b.size());
  r = b;
  if (!x.isZero(0)) {
    multiply(A, x, image, work);
    r -= image;
  }
  const double b_norm = std::sqrt(dot(b, b));
  double r_norm = std::sqrt(dot(r, r));
  if (r_norm <= relative_tolerance * b_norm) {
    report.relative_residual = b_norm > 0 ? r_norm / b_norm : 0;
    return report;
  }
  p.setZero(b.size());
  double previous_rz = 1;
  report.status = LinearReport::Status::not_converged;
  while (report.iterations < max_iterations_) {
    preconditioner_->apply(r, r_norm, image);
    const double rz = dot(r, image);
    if (!(rz > 0) || !std::isfinite(rz)) break;  // the preconditioner has lost definiteness to round-off
    const double along_last = report.iterations == 0 ? 0.0 : rz / previous_rz;
    parallel_for(n, numbers_per_chunk, [&](std::size_t begin, std::size_t end) {
      kernels.xpby(image.data() + begin, along_last, p.data() + begin, static_cast<Offset>(end - begin));
    });
    multiply(A, p, image, work);
    const double curvature = dot(p, image);
    if (!(curvature > 0)) {
      report.status = LinearReport::Status::indefinite;
      report.worst_node = most_negative_node(p, image, A.dim);
      if (report.iterations == 0 && x.isZero(0)) x = p;
      break;
    }
    const double step = rz / curvature;
    r_norm = std::sqrt(parallel_sum<double>(n, numbers_per_chunk, [&](std::size_t begin, std::size_t end) {
      const auto count = static_cast<Offset>(end - begin);
      kernels.axpy(step, p.data() + begin, x.data() + begin, count);
      kernels.axpy(-step, image.data() + begin, r.data() + begin, count);
      return kernels.dot(r.data() + begin, r.data() + begin, count);
    }));
    previous_rz = rz;
    ++report.iterations;
    if (r_norm <= relative_tolerance * b_norm) {
      report.status = LinearReport::Status::ok;
      break;
    }
  }
  report.relative_residual = r_norm / b_norm;
  judge_preconditioner(report.iterations, relative_tolerance);
  return report;
}

}  // namespace resilin
