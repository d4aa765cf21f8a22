#include "resilin/linear/dependents.hpp"

#include <gtest/gtest.h>

#include "sample_matrix.hpp"

namespace resilin::testing {
namespace {

/// Whole nodes, single components, a node that follows two of its neighbours and itself.
std::vector<Dependents::Relation> sample_relations(int dim) {
  return {{4 * dim, {{9 * dim, 0.3}, {2 * dim, 0.7}}},
          {4 * dim + 1, {{9 * dim + 1, 1.5}}},
          {6 * dim + 1, {{6 * dim, -2}, {1 * dim + 1, 0.25}}},
          {11 * dim, {}}};
}

Eigen::MatrixXd dense_of(const std::vector<Dependents::Relation>& relations, Index num_unknowns) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Identity(num_unknowns, num_unknowns);
  for (const Dependents::Relation& relation : relations) {
    C.row(relation.unknown).setZero();
    for (const Dependents::Weight& weight : relation.by) C(relation.unknown, weight.unknown) = weight.value;
  }
  return C;
}

TEST(Dependents, ReduceMatricesWithExtraBlocks) {
  for (const int dim : {2, 3}) {
    const BlockMatrix sample = sample_matrix(dim, 14, 5, 6);
    const Dependents dependents(dim, 14 * dim, sample_relations(dim));
    const Eigen::MatrixXd C = dense_of(sample_relations(dim), 14 * dim);
    const Eigen::MatrixXd expected = C.transpose() * dense(sample) * C;
    // On its own pattern what is new stands beside it, on the extended one nothing does.
    BlockMatrix narrow = sample;
    dependents.reduce(narrow);
    EXPECT_LT((dense(narrow) - expected).norm(), 1e-13 * expected.norm());

    BlockPatternBuilder builder(14);
    for (Index i = 0; i < 14; ++i)
      for (Offset s = sample.pattern->row_begin[i]; s < sample.pattern->row_begin[i + 1]; ++s)
        builder.add_pair(i, sample.pattern->columns[s]);
    for (const BlockMatrix::ExtraBlock& extra : sample.extra) builder.add_pair(extra.row, extra.column);
    const BlockPattern pattern = builder.build();
    BlockMatrix wide(dim, std::make_shared<const BlockPattern>(dependents.extended(pattern, builder)));
    for (Index i = 0; i < 14; ++i)
      for (Offset s = sample.pattern->row_begin[i]; s < sample.pattern->row_begin[i + 1]; ++s)
        wide.add_block(i, sample.pattern->columns[s], sample.block(s));
    for (const BlockMatrix::ExtraBlock& extra : sample.extra)
      wide.add_block(extra.row, extra.column, &sample.extra_values[extra.begin]);
    dependents.reduce(wide);
    EXPECT_TRUE(wide.extra.empty());
    EXPECT_LT((dense(wide) - expected).norm(), 1e-13 * expected.norm());
  }
}

TEST(Dependents, FollowInPositionsAndPassForcesOn) {
  constexpr int dim = 3;
  const Dependents dependents(dim, 14 * dim, sample_relations(dim));
  const Eigen::MatrixXd C = dense_of(sample_relations(dim), 14 * dim);
  const VectorX x = VectorX::LinSpaced(14 * dim, -1, 2);
  VectorX constants = VectorX::Zero(14 * dim), placed = x;
  constants[4 * dim] = 0.5;
  dependents.place(constants, placed);
  EXPECT_LT((placed - C * x - constants).norm(), 1e-14);

  VectorX forces = x;
  dependents.add_forces(forces);
  VectorX expected = C.transpose() * x;
  for (const Dependents::Relation& relation : dependents.relations()) {
    EXPECT_TRUE(dependents.is_dependent(relation.unknown));
    expected[relation.unknown] = x[relation.unknown];  // the force that holds it
  }
  EXPECT_LT((forces - expected).norm(), 1e-14);
}

}  // namespace
}  // namespace resilin::testing
