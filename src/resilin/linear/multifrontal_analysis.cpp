#include "resilin/linear/multifrontal_analysis.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <ranges>

#include "resilin/linear/ordering.hpp"

namespace resilin {
namespace {

/// Positions of the lower neighbours and the elimination tree follow from the graph and an order.
struct OrderedGraph {
  const NodeGraph& graph;
  const std::vector<Index>& node_at;
  std::vector<Index> position;

  OrderedGraph(const NodeGraph& the_graph, const std::vector<Index>& order)
      : graph(the_graph), node_at(order), position(order.size()) {
    for (Index i = 0; i < size(); ++i) position[node_at[i]] = i;
  }
  Index size() const { return static_cast<Index>(node_at.size()); }

  template <class Visit>
  void for_neighbours(Index i, const Visit& visit) const {
    for (Index k = graph.begin[node_at[i]]; k < graph.begin[node_at[i] + 1]; ++k)
      visit(position[graph.neighbours[k]]);
  }
};

/// Parent of every column, -1 for a root. Source: Liu 1986, with path compression.
std::vector<Index> elimination_tree(const OrderedGraph& ordered) {
  std::vector<Index> parent(ordered.node_at.size(), -1), ancestor(ordered.node_at.size(), -1);
  for (Index j = 0; j < ordered.size(); ++j)
    ordered.for_neighbours(j, [&](Index i) {
      while (i >= 0 && i < j) {
        const Index next = ancestor[i];
        ancestor[i] = j;
        if (next < 0) parent[i] = j;
        i = next;
      }
    });
  return parent;
}

/// Columns such that children come before their parents and every subtree is consecutive.
std::vector<Index> postorder(const std::vector<Index>& parent) {
  const auto n = static_cast<Index>(parent.size());
  std::vector<Index> first_child(parent.size(), -1), sibling(parent.size(), -1), order, stack;
  for (Index i = n - 1; i >= 0; --i) {
    if (parent[i] < 0) continue;
    sibling[i] = first_child[parent[i]];
    first_child[parent[i]] = i;
  }
  for (Index root = 0; root < n; ++root) {
    if (parent[root] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const Index i = stack.back();
      if (first_child[i] >= 0) {
        stack.push_back(first_child[i]);
        first_child[i] = sibling[first_child[i]];
      } else {
        order.push_back(i);
        stack.pop_back();
      }
    }
  }
  return order;
}

struct Columns {
  Index first, count;
  std::vector<Index> rows;  // below
  double zeros = 0;         // blocks stored for nothing
};

/// Supernodes in the strict sense: column j joins the one before when that is its only child and has its
/// rows.
std::vector<Columns> fundamental_supernodes(const OrderedGraph& ordered, const std::vector<Index>& parent) {
  std::vector<Columns> supernodes;
  std::vector<int> num_children(parent.size(), 0);
  for (const Index p : parent)
    if (p >= 0) ++num_children[p];
  std::vector<Index> mark(parent.size(), -1);              // supernode in whose rows a position stands
  std::vector<std::vector<Index>> waiting(parent.size());  // by column: supernodes whose parent it is
  for (Index j = 0; j < ordered.size(); ++j) {
    const auto current = static_cast<Index>(supernodes.size()) - 1;
    bool joins = j > 0 && parent[j - 1] == j && num_children[j] == 1;
    if (joins) ordered.for_neighbours(j, [&](Index i) { joins = joins && (i <= j || mark[i] == current); });
    if (joins) {
      ++supernodes.back().count;
    } else {
      const Index id = current + 1;
      Columns next{.first = j, .count = 1, .rows = {}};
      const auto add = [&](Index i) {
        if (i <= j || mark[i] == id) return;
        mark[i] = id;
        next.rows.push_back(i);
      };
      for (const Index child : waiting[j])
        for (const Index i : supernodes[child].rows) add(i);
      ordered.for_neighbours(j, add);
      supernodes.push_back(std::move(next));
    }
    // A supernode hands its rows to the parent of its last column; until the next column joins, that is this
    // one.
    if (parent[j] >= 0) waiting[parent[j]].push_back(static_cast<Index>(supernodes.size()) - 1);
  }
  for (Columns& supernode : supernodes) {
    std::erase_if(supernode.rows, [&](Index i) { return i < supernode.first + supernode.count; });
    std::sort(supernode.rows.begin(), supernode.rows.end());
  }
  return supernodes;
}

/// Merging a small supernode into its parent stores some zeros and spares many small operations.
bool is_worth_merging(double width, double added_zeros, double share_of_zeros) {
  return added_zeros <= 0 || width <= 2 || (width <= 6 && share_of_zeros < 0.8) ||
         (width <= 16 && share_of_zeros < 0.15) || (width <= 32 && share_of_zeros < 0.08) ||
         share_of_zeros < 0.03;
}

std::vector<Columns> relax(std::vector<Columns> supernodes) {
  std::vector<Columns> result;
  for (Columns& supernode : supernodes) {
    Columns current = std::move(supernode);
    while (!result.empty()) {
      const Columns& child = result.back();
      const bool is_last_child = child.first + child.count == current.first && !child.rows.empty() &&
                                 child.rows.front() < current.first + current.count;
      if (!is_last_child) break;
      const auto num_rows = static_cast<double>(current.rows.size());
      const double added = child.count * (current.count + num_rows - static_cast<double>(child.rows.size()));
      const double width = child.count + current.count;
      const double zeros = current.zeros + child.zeros + added;
      if (!is_worth_merging(width, added, zeros / (width * (width + 1) / 2 + width * num_rows))) break;
      current.first = child.first;
      current.count += child.count;
      current.zeros = zeros;
      result.pop_back();
    }
    result.push_back(std::move(current));
  }
  return result;
}

std::vector<Columns> find_supernodes(const OrderedGraph& ordered) {
  return relax(fundamental_supernodes(ordered, elimination_tree(ordered)));
}

Offset panel_blocks(Index num_columns, Index front_size) {
  return TrapezoidLayout{front_size, TrapezoidLayout::nodes_per_block}.size(num_columns);
}

Offset update_blocks(Index num_rows) { return panel_blocks(num_rows, num_rows); }

/// Puts the children of every supernode into the order in which factor and update matrices together grow
/// least: the highest peak above what is left of it first. Renumbers the columns, children before parents as
/// before.
///
/// Source: Liu 1986 (ACM Trans. Math. Softw. 12, 249).
std::vector<Columns> order_children(std::vector<Columns> supernodes, std::vector<Index>& node_at) {
  const auto n = supernodes.size();
  std::vector<Index> supernode_of(node_at.size());
  for (std::size_t s = 0; s < n; ++s)
    for (Index i = 0; i < supernodes[s].count; ++i)
      supernode_of[supernodes[s].first + i] = static_cast<Index>(s);
  std::vector<std::vector<Index>> children(n + 1);  // the last: the roots
  std::vector<Offset> update(n), left(n), peak(n);  // left: the factor of the subtree and its update
  const auto sort = [&](std::vector<Index>& siblings) {
    std::ranges::stable_sort(siblings, std::greater(), [&](Index s) { return peak[s] - left[s]; });
  };
  for (std::size_t s = 0; s < n; ++s) {
    const Index count = supernodes[s].count, num_rows = static_cast<Index>(supernodes[s].rows.size());
    update[s] = update_blocks(num_rows);
    sort(children[s]);
    Offset used = 0, taken_up = 0;
    for (const Index child : children[s]) {
      peak[s] = std::max(peak[s], used + peak[child]);
      used += left[child];
      taken_up += update[child];
    }
    used += panel_blocks(count, count + num_rows) + update[s];
    peak[s] = std::max(peak[s], used);
    left[s] = used - taken_up;
    children[supernodes[s].rows.empty() ? n : static_cast<std::size_t>(supernode_of[supernodes[s].rows[0]])]
        .push_back(static_cast<Index>(s));
  }
  // Parents first and the last child before the others, then backwards.
  std::vector<Index> sequence, stack = children[n];
  while (!stack.empty()) {
    const Index s = stack.back();
    stack.pop_back();
    sequence.push_back(s);
    stack.insert(stack.end(), children[s].begin(), children[s].end());
  }
  std::vector<Columns> result;
  std::vector<Index> new_node_at, position(node_at.size());
  for (const Index s : std::views::reverse(sequence)) {
    Columns& columns = supernodes[s];
    const auto first = static_cast<Index>(new_node_at.size());
    for (Index i = columns.first; i < columns.first + columns.count; ++i) {
      position[i] = static_cast<Index>(new_node_at.size());
      new_node_at.push_back(node_at[i]);
    }
    columns.first = first;
    result.push_back(std::move(columns));
  }
  for (Columns& columns : result)  // columns of ancestors, whose order is as it was
    for (Index& row : columns.rows) row = position[row];
  node_at = std::move(new_node_at);
  return result;
}

double flops_of(const Supernode& supernode) {
  const double c = supernode.num_columns, r = supernode.num_rows();
  return c * c * c / 3 + c * c * r + c * r * r;
}

/// Subtrees below a share of the whole work, so that two or more threads are busy; the split does not depend
/// on the number of threads.
void split_tree(MultifrontalAnalysis& analysis) {
  constexpr double largest_share = 1.0 / 8;
  const auto n = static_cast<Index>(analysis.supernodes.size());
  std::vector<double> work(static_cast<std::size_t>(n), 0.0);
  std::vector<Index> first_descendant(static_cast<std::size_t>(n));
  std::iota(first_descendant.begin(), first_descendant.end(), 0);
  for (Index s = 0; s < n; ++s) {
    work[s] += flops_of(analysis.supernodes[s]);
    const Index parent = analysis.supernodes[s].parent;
    if (parent < 0) continue;
    work[parent] += work[s];
    first_descendant[parent] = std::min(first_descendant[parent], first_descendant[s]);
  }
  double total = 0;
  for (Index s = 0; s < n; ++s)
    if (analysis.supernodes[s].parent < 0) total += work[s];
  for (Index s = 0; s < n; ++s) {
    const Index parent = analysis.supernodes[s].parent;
    if (work[s] > largest_share * total) {
      analysis.top.push_back(s);
    } else if (parent < 0 || work[parent] > largest_share * total) {
      const bool joins = !analysis.subtrees.empty() &&
                         analysis.subtrees.back().second == first_descendant[s] &&
                         parent < 0;  // many small roots are one task
      if (joins) {
        analysis.subtrees.back().second = s + 1;
      } else {
        analysis.subtrees.emplace_back(first_descendant[s], s + 1);
      }
    }
  }
}

/// Plays a factorisation front by front, backwards: the later an update is held, the more of the shared array
/// the factor has taken, and the nearer to the array's end it lies.
void place_updates(MultifrontalAnalysis& analysis) {
  struct Held {
    Offset begin, end;  // from the end of the array
    Index front;
  };
  std::vector<Held> held;  // ascending
  const auto n = static_cast<Index>(analysis.supernodes.size());
  analysis.shared_blocks = analysis.factor_blocks;
  analysis.update_begin.assign(static_cast<std::size_t>(n), 0);
  for (Index s = n - 1; s >= 0; --s) {
    for (Index k = analysis.child_begin[s]; k < analysis.child_begin[s + 1]; ++k) {
      const Index child = analysis.children[k];
      const Offset size = update_blocks(analysis.supernodes[child].num_rows());
      Offset begin = 0;
      auto next = held.begin();
      for (; next != held.end() && next->begin - begin < size; ++next) begin = next->end;
      held.insert(next, {begin, begin + size, child});
      analysis.update_begin[child] = begin + size;
    }
    const Offset factor_end = s + 1 < n ? analysis.supernodes[s + 1].factor_begin : analysis.factor_blocks;
    const Offset length = held.empty() ? 0 : held.back().end;
    analysis.shared_blocks = std::max(analysis.shared_blocks, factor_end + length);
    std::erase_if(held, [&](const Held& update) { return update.front == s; });
  }
  for (Offset& begin : analysis.update_begin) begin = analysis.shared_blocks - begin;
}

/// Plays the factorisation of subtrees through to see how high the stacks grow.
void size_stacks(MultifrontalAnalysis& analysis) {
  const auto n = static_cast<Index>(analysis.supernodes.size());
  analysis.stack_of.assign(static_cast<std::size_t>(n), 0);
  for (Index s = n - 1; s >= 0; --s)
    if (analysis.supernodes[s].parent >= 0)
      analysis.stack_of[s] = 1 - analysis.stack_of[analysis.supernodes[s].parent];
  analysis.root_update_begin.assign(static_cast<std::size_t>(n), -1);
  for (const auto& [first, last] : analysis.subtrees) {
    analysis.root_update_begin[last - 1] = analysis.root_update_blocks;
    analysis.root_update_blocks += update_blocks(analysis.supernodes[last - 1].num_rows());
  }
  using Sizes = MultifrontalAnalysis::StackSizes;
  const auto visit = [&](Index s, Sizes& used, Sizes& peak) {
    const auto is_on_stack = [&](Index t) { return analysis.root_update_begin[t] < 0; };
    const int own = analysis.stack_of[s];
    if (is_on_stack(s)) used.blocks[own] += update_blocks(analysis.supernodes[s].num_rows());
    peak.blocks[own] = std::max(peak.blocks[own], used.blocks[own]);
    for (Index k = analysis.child_begin[s]; k < analysis.child_begin[s + 1]; ++k)
      if (is_on_stack(analysis.children[k]))
        used.blocks[1 - own] -= update_blocks(analysis.supernodes[analysis.children[k]].num_rows());
  };
  Sizes used_by_top;
  for (const auto& [first, last] : analysis.subtrees) {
    Sizes used;
    for (Index s = first; s < last; ++s) visit(s, used, analysis.subtree_stacks);
  }
  for (const Index s : analysis.top) visit(s, used_by_top, analysis.top_stacks);
}

}  // namespace

MultifrontalAnalysis::MultifrontalAnalysis(const MergedPattern& pattern) {
  const NodeGraph graph(pattern);
  const std::vector<Index> order = fill_reducing_order(graph);
  for (const Index i : postorder(elimination_tree(OrderedGraph(graph, order)))) node_at.push_back(order[i]);
  const std::vector<Columns> columns = order_children(find_supernodes(OrderedGraph(graph, node_at)), node_at);
  const OrderedGraph ordered(graph, node_at);

  std::vector<Index> supernode_of(node_at.size());
  for (const Columns& column : columns) {
    Supernode supernode{.first = column.first, .num_columns = column.count};
    supernode.rows_begin = static_cast<Offset>(rows.size());
    rows.insert(rows.end(), column.rows.begin(), column.rows.end());
    supernode.rows_end = static_cast<Offset>(rows.size());
    supernode.factor_begin = factor_blocks;
    factor_blocks += panel_blocks(supernode.num_columns, supernode.front_size());
    for (Index i = column.first; i < column.first + column.count; ++i)
      supernode_of[i] = static_cast<Index>(supernodes.size());
    supernodes.push_back(supernode);
  }
  const auto place_in = [&](const Supernode& supernode, Index i) -> Index {
    if (i < supernode.first + supernode.num_columns) return i - supernode.first;
    const auto begin = rows.begin() + supernode.rows_begin;
    return supernode.num_columns +
           static_cast<Index>(std::lower_bound(begin, rows.begin() + supernode.rows_end, i) - begin);
  };
  places.resize(rows.size());
  child_begin.assign(supernodes.size() + 1, 0);
  for (Supernode& supernode : supernodes) {
    if (supernode.num_rows() == 0) continue;
    supernode.parent = supernode_of[rows[supernode.rows_begin]];
    ++child_begin[supernode.parent + 1];
    for (Offset k = supernode.rows_begin; k < supernode.rows_end; ++k)
      places[k] = place_in(supernodes[supernode.parent], rows[k]);
  }
  for (std::size_t s = 0; s < supernodes.size(); ++s) child_begin[s + 1] += child_begin[s];
  children.resize(static_cast<std::size_t>(child_begin.back()));
  std::vector<Index> next(child_begin.begin(), child_begin.end() - 1);
  for (Index s = 0; s < static_cast<Index>(supernodes.size()); ++s)
    if (supernodes[s].parent >= 0) children[next[supernodes[s].parent]++] = s;

  entry_begin.assign(supernodes.size() + 1, 0);
  const auto for_slots = [&](const auto& visit) {
    for (Index u = 0; u < pattern.num_nodes(); ++u)
      for (Offset slot = pattern.row_begin[u]; slot < pattern.row_begin[u + 1]; ++slot) {
        const Index i = ordered.position[u], j = ordered.position[pattern.columns[slot]];
        visit(slot, i, j, supernode_of[std::min(i, j)]);
      }
  };
  for_slots([&](Offset, Index, Index, Index s) { ++entry_begin[s + 1]; });
  for (std::size_t s = 0; s < supernodes.size(); ++s) entry_begin[s + 1] += entry_begin[s];
  entries.resize(static_cast<std::size_t>(entry_begin.back()));
  std::vector<Offset> next_entry(entry_begin.begin(), entry_begin.end() - 1);
  for_slots([&](Offset slot, Index i, Index j, Index s) {
    // The slot holds A(i, j); the panel wants the block whose row is the later position.
    entries[next_entry[s]++] = {slot, place_in(supernodes[s], std::max(i, j)),
                                std::min(i, j) - supernodes[s].first, j > i};
  });
  split_tree(*this);
  place_updates(*this);
  size_stacks(*this);
}

}  // namespace resilin
