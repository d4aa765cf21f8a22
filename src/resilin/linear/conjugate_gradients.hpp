#pragma once

#include <memory>
#include <string>
#include <vector>

#include "resilin/linear/linear_solver.hpp"
#include "resilin/linear/matrix_sample.hpp"

namespace resilin {

/// z = M^-1 r for a symmetric positive definite M near to A.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  virtual void analyze(const BlockMatrix& A, const VectorX& node_positions) = 0;
  virtual LinearReport factorize(const BlockMatrix& A) = 0;
  virtual void release() = 0;  ///< gives back its memory
  /// Approximate memory for each coupling of the pattern [bytes].
  virtual double bytes_per_coupling(int dim) const = 0;
  /// @param norm  |r|, positive: what is computed in float is scaled by it
  virtual void apply(const VectorX& r, double norm, VectorX& z) = 0;
};

/// Conjugate gradients with the preconditioner given. Kept between solves are its memory, the vectors of
/// small systems, and within a search the preconditioner of one matrix, with the positions that it was made
/// for, for those that are near to it.
///
/// Source: Saad 2003, algorithm 9.1. Stops where p^T A p <= 0, and returns the iterate so far (the
/// preconditioned right side when that is the start): Nocedal & Wright 2006, algorithm 7.1.
class ConjugateGradients : public LinearSolver {
 public:
  ConjugateGradients(std::string name, int max_iterations, std::unique_ptr<Preconditioner> preconditioner)
      : name_(std::move(name)), max_iterations_(max_iterations), preconditioner_(std::move(preconditioner)) {}

  std::string_view name() const override { return name_; }
  bool is_direct() const override { return false; }
  double expected_bytes(const BlockPattern& pattern, int dim) const override {
    return preconditioner_->bytes_per_coupling(dim) * static_cast<double>(pattern.num_slots());
  }
  void begin_search() override { factorized_.forget(); }
  void release() override {
    factorized_.forget();
    preconditioner_->release();
  }
  void analyze(const BlockMatrix& A, const VectorX& node_positions) override;
  LinearReport factorize(const BlockMatrix& A) override;
  LinearReport solve(const BlockMatrix& A, const VectorX& b, VectorX& x, double relative_tolerance) override;

 private:
  struct Vectors {
    VectorX r, p, image;  ///< `image`: r by M^-1, then p by A
    std::vector<double> work;
  };
  void foresee(const BlockMatrix& A);
  LinearReport iterate(const BlockMatrix& A, const VectorX& b, VectorX& x, double relative_tolerance);

  std::string name_;
  std::shared_ptr<const BlockPattern> foreseen_;  ///< there was memory for it
  int max_iterations_;
  std::unique_ptr<Preconditioner> preconditioner_;
  void judge_preconditioner(int iterations, double relative_tolerance);

  MatrixSample factorized_;  ///< matrix of the preconditioner that is held; nothing where none is, or in
                             ///< another search
  double iterations_per_digit_ = 0;  ///< iterations per digit of the first solve with it; 0 before
  Vectors vectors_;
};

}  // namespace resilin
