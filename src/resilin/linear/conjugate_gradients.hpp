#pragma once

#include <memory>
#include <string>
#include <vector>

#include "resilin/linear/linear_solver.hpp"

namespace resilin {

/// z = M^-1 r for a symmetric positive definite M near to A.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  virtual void analyze(const BlockMatrix& A, const VectorX& node_positions) = 0;
  virtual LinearReport factorize(const BlockMatrix& A) = 0;
  virtual void apply(const VectorX& r, VectorX& z) = 0;
};

/// Conjugate gradients with the preconditioner given. All memory is kept between solves.
///
/// Source: Saad 2003, algorithm 9.1. Stops where p^T A p <= 0, and returns the iterate so far (the
/// preconditioned right side when that is the start): Nocedal & Wright 2006, algorithm 7.1.
class ConjugateGradients : public LinearSolver {
 public:
  ConjugateGradients(std::string name, int max_iterations, std::unique_ptr<Preconditioner> preconditioner)
      : name_(std::move(name)), max_iterations_(max_iterations), preconditioner_(std::move(preconditioner)) {}

  std::string_view name() const override { return name_; }
  bool is_direct() const override { return false; }
  void analyze(const BlockMatrix& A, const VectorX& node_positions) override {
    preconditioner_->analyze(A, node_positions);
  }
  LinearReport factorize(const BlockMatrix& A) override { return preconditioner_->factorize(A); }
  LinearReport solve(const BlockMatrix& A, const VectorX& b, VectorX& x, double relative_tolerance) override;

 private:
  std::string name_;
  int max_iterations_;
  std::unique_ptr<Preconditioner> preconditioner_;
  VectorX r_, z_, p_, product_;
  std::vector<double> work_;
};

}  // namespace resilin
