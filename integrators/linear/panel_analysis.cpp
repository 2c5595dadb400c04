/// The plan of a multifrontal factorisation, step by step: groups of unknowns, order, elimination tree,
/// panels, rows, and the places of all numbers.
#include "integrators/linear/panel_analysis.hpp"

#include <algorithm>
#include <numeric>

#include "integrators/linear/elimination_order.hpp"
#include "integrators/linear/panel_kernels.hpp"

namespace hmax {
namespace {

using Index = PanelAnalysis::Index;
using Indices = std::vector<Index>;

/// The unknowns of a pattern, those that have one and the same taken for one: the graph of a body,
/// whose points have three unknowns each, then has a third of the vertices.
struct Groups {
  Indices first{0};  ///< unknown of each group, and one more
  Indices of;        ///< group of each unknown
  Graph graph;       ///< an edge where an entry of A connects two groups

  /// @param outer, inner  symmetric pattern of n columns, rows ascending; shapes (n + 1), (entries)
  Groups(std::span<const Index> outer, std::span<const Index> inner) {
    const auto n = static_cast<Index>(outer.size()) - 1;
    // Rows of column j, ascending.
    const auto column = [&](Index j) { return inner.subspan(outer[j], outer[j + 1] - outer[j]); };
    of.resize(n);
    for (Index j = 0; j < n; ++j) {
      // Equal patterns of adjacent columns: one group. Since the diagonal is among the rows, its unknowns are
      // all neighbours of one another.
      if (j > 0 && !std::ranges::equal(column(j), column(j - 1))) first.push_back(j);
      of[j] = static_cast<Index>(first.size()) - 1;
    }
    // The end of the last group.
    if (n > 0) first.push_back(n);
    // Edges: each neighbour once, though its unknowns stand side by side in the column.
    for (Index g = 0; g + 1 < static_cast<Index>(first.size()); ++g) {
      Index last = -1;
      for (const Index i : column(first[g])) {
        if (of[i] != last && of[i] != g) graph.to.push_back(of[i]);
        last = of[i];
      }
      graph.first.push_back(static_cast<Index>(graph.to.size()));
    }
  }
  [[nodiscard]] Index count() const { return graph.size(); }
  [[nodiscard]] Index size(Index g) const { return first[g + 1] - first[g]; }  ///< unknowns of group g
};

/// The graph with vertex order[k] called k. Neighbours of a vertex need not ascend afterwards.
/// @param order  a permutation of the vertices, shape (n)
Graph renamed(const Graph& graph, const Indices& order) {
  // name: the inverse of order.
  Indices name(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) name[order[k]] = static_cast<Index>(k);
  Graph out;
  for (const Index v : order) {
    for (const Index u : graph.of(v)) out.to.push_back(name[u]);
    out.first.push_back(static_cast<Index>(out.to.size()));
  }
  return out;
}

/// The elimination tree: of each vertex, the first later one that its elimination touches; -1: none. It is
/// that of L: parent[j] is the row of the first entry below the diagonal of column j.
/// @source [davis2016survey] 4.1
Indices elimination_tree(const Graph& graph) {
  // root[v]: an ancestor of v, the highest one that a walk through v has seen; -1: v is a root so far.
  Indices parent(graph.size(), -1), root(graph.size(), -1);
  for (Index k = 0; k < graph.size(); ++k)
    // Up from each earlier neighbour of k to the root of its subtree, whose parent k becomes. root[]
    // compresses the path.
    for (Index v : graph.of(k)) {
      while (v != -1 && v < k) {
        const Index above = root[v];
        root[v] = k;
        if (above == -1) parent[v] = k;
        v = above;
      }
    }
  return parent;
}

/// The vertices with every subtree together, roots last: a depth-first search without recursion, whose depth
/// could be that of the whole tree.
/// @param parent  of each vertex, a later one, or -1
Indices postorder(const Indices& parent) {
  const auto n = static_cast<Index>(parent.size());
  Indices child(n, -1), next(n, -1), order, way;
  // Children of each vertex as a list, the first one the smallest.
  for (Index v = n; v-- > 0;)
    if (parent[v] >= 0) {
      next[v] = child[parent[v]];
      child[parent[v]] = v;
    }
  for (Index v = 0; v < n; ++v) {
    if (parent[v] >= 0) continue;
    way.push_back(v);
    while (!way.empty()) {
      // Down to the first child that is left, else the vertex itself is next.
      const Index top = way.back();
      if (const Index below = child[top]; below >= 0) {
        child[top] = next[below];
        way.push_back(below);
      } else {
        order.push_back(top);
        way.pop_back();
      }
    }
  }
  return order;
}

/// Sums of squares: from^2 excluded ... to^2, that is sum_{from < m <= to} m^2. In double, since the cube of
/// a height of some thousands is beyond 32 bits.
double squares(double from, double to) {
  // 1 + 4 + ... + m^2
  const auto up_to = [](double m) { return m * (m + 1) * (2 * m + 1) / 6; };
  return up_to(to) - up_to(from);
}

/// The vertices of a graph in the order of their elimination.
struct Elimination {
  Indices order;   ///< group of each vertex
  Indices parent;  ///< in the elimination tree
  Graph graph;     ///< edges to later and to earlier vertices
  Indices size;    ///< unknowns of each vertex
  Indices height;  ///< rows of L below each vertex, counted in unknowns

  /// @param given  vertex given[k] of the graph of the groups is the k-th
  Elimination(const Groups& groups, Indices given) : order(std::move(given)) {
    // As given first, then a postorder of that tree: subtrees become contiguous, the fill stays the same.
    const Graph as_given = renamed(groups.graph, order);
    const Indices tree = elimination_tree(as_given);
    // A tree of any order is that of its postorder, renamed.
    const Indices after = postorder(tree);
    Indices name(after.size());
    const Indices before = std::move(order);
    for (std::size_t k = 0; k < after.size(); ++k) name[after[k]] = static_cast<Index>(k);
    order.clear();
    for (const Index v : after) {
      order.push_back(before[v]);
      parent.push_back(tree[v] < 0 ? -1 : name[tree[v]]);
      size.push_back(groups.size(before[v]));
    }
    graph = renamed(as_given, after);
    count_rows();
  }
  [[nodiscard]] Index count() const { return graph.size(); }

  /// Operations of a factorisation, by the columns of L: see PanelAnalysis::work, but without the zeros that
  /// panels add.
  [[nodiscard]] double work() const {
    double sum = 0;
    for (Index v = 0; v < count(); ++v) sum += squares(height[v], height[v] + size[v]);
    return sum;
  }

 private:
  /// Row i of L has an entry in every vertex on the way up from a neighbour to i. So the heights grow row by
  /// row.
  void count_rows() {
    height.assign(parent.size(), 0);
    Indices seen(parent.size(), -1);
    for (Index i = 0; i < count(); ++i) {
      seen[i] = i;
      for (Index v : graph.of(i))
        for (; v < i && seen[v] != i; v = parent[v]) {
          seen[v] = i;
          height[v] += size[i];
        }
    }
  }
};

/// The order of least work: by minimum degree, or where that leaves more work than nested dissection takes,
/// the better one of the two.
Elimination best_elimination(const Groups& groups) {
  Elimination best(groups, minimum_degree(groups.graph));
  if (best.work() < dissection_work(groups.graph)) return best;
  if (Indices order = nested_dissection(groups.graph); !order.empty())
    if (Elimination dissected(groups, std::move(order)); dissected.work() < best.work()) return dissected;
  return best;
}

/// Panels in the making: each is known by its last vertex, to which the others point.
class Merging {
 public:
  explicit Merging(const Elimination& vertices)
      : parent_(vertices.parent),
        width_(vertices.size),
        height_(vertices.height),
        zeros_(parent_.size(), 0),
        into_(parent_.size()) {
    std::iota(into_.begin(), into_.end(), 0);
    // First, children whose rows are the unknowns and rows of their parent: no zeros are added.
    merge([](double, double, double zeros) { return zeros == 0; });
    // A few zeros are cheaper than many small panels [ashcraft1989influence]: the narrower the panel, the
    // larger the share of zeros among its entries that it may have.
    merge([](double width, double entries, double zeros) {
      return zeros < (width <= 24 ? 0.3 : width <= 48 ? 0.15 : 0.05) * entries;
    });
  }

  /// The last vertex of the panel that v is in.
  [[nodiscard]] Index panel_of(Index v) {
    // Path halving.
    while (into_[v] != v) v = into_[v] = into_[into_[v]];
    return v;
  }

 private:
  /// Merges children into their parents where allowed(width, entries, zeros among them) of the whole.
  /// Vertices come in postorder: what is merged into a child is there before its parent looks at it.
  template <class Allowed>
  void merge(const Allowed& allowed) {
    const auto n = static_cast<Index>(parent_.size());
    // Panels by the panel of their parent, as the merging before this one has left them.
    std::vector<Indices> children(n);
    for (Index v = 0; v < n; ++v)
      if (into_[v] == v && parent_[v] >= 0) children[panel_of(parent_[v])].push_back(v);
    for (Index v = 0; v < n; ++v) {
      if (into_[v] != v) continue;
      // The one that adds the fewest zeros first.
      std::ranges::sort(children[v], {}, [&](Index c) {
        return std::pair(static_cast<double>(width_[c]) * (width_[v] + height_[v] - height_[c]), c);
      });
      for (const Index c : children[v]) {
        const double wc = width_[c], width = wc + width_[v];
        // Columns of the child get the rows that only the parent has: its own ones are among the unknowns and
        // the rows of the parent, so it lacks the difference in number.
        const double zeros = zeros_[c] + zeros_[v] + wc * (width_[v] + height_[v] - height_[c]);
        // Entries: a triangle of `width` unknowns, and the rows below it.
        if (!allowed(width, width * (width / 2 + height_[v]), zeros)) continue;
        // The child's columns join the panel of v, whose rows stay.
        into_[c] = v;
        width_[v] += width_[c];
        zeros_[v] = zeros;
      }
    }
  }

  /// Of each panel, at its last vertex: the parent vertex of the tree, unknowns, and rows below.
  Indices parent_, width_, height_;
  std::vector<double> zeros_;  ///< entries that are zero in L, by merging
  Indices into_;               ///< next vertex on the way to the last one of the panel
};

/// Fills a plan, by steps that need those before them.
class Planner {
 public:
  Planner(PanelAnalysis& plan, std::span<const Index> outer, std::span<const Index> inner)
      : plan_(plan),
        outer_(outer),
        inner_(inner),
        groups_(outer, inner),
        vertices_(best_elimination(groups_)) {}

  /// The vertices of each panel, by merging; then panel_ and members_.
  void gather_panels();
  /// plan_.to, and of each panel its first unknown, width and parent.
  void number_unknowns();
  /// plan_.rows, and the height of each panel.
  void find_rows();
  /// Where T and B of each panel are; tallest, widest and work of the plan.
  void place_values();
  /// Where updates are, and how many numbers they hold at most.
  void place_updates();
  /// plan_.joins: runs of rows of a panel that are contiguous in its parent.
  void join_rows();
  /// plan_.entries: runs of entries of A that are contiguous in a panel.
  void place_entries();

 private:
  [[nodiscard]] Index count() const { return static_cast<Index>(plan_.panels.size()); }  ///< panels
  /// The vertices of panel p, ascending.
  [[nodiscard]] std::span<const Index> members_of(Index p) const {
    return std::span(members_).subspan(members_first_[p], members_first_[p + 1] - members_first_[p]);
  }
  void join_rows_of(PanelAnalysis::Panel& here);
  void place_entries_of(Index p, const Indices& row_at);

  /// The plan that is filled, and the pattern of A; they must outlive the planner.
  PanelAnalysis& plan_;
  std::span<const Index> outer_, inner_;
  Groups groups_;
  Elimination vertices_;
  Indices panel_;                    ///< of each vertex
  Indices members_first_, members_;  ///< vertices of each panel
  Indices first_;                    ///< unknown of each vertex in L
};

/// Panels, in the order of their last vertices, which is a postorder again. The vertices of a panel need not
/// follow one another: a child that was merged may have siblings after it that were not.
void Planner::gather_panels() {
  const Index n = vertices_.count();
  // Which vertices make a panel.
  Merging merging(vertices_);
  Indices number(n, -1);
  for (Index v = 0; v < n; ++v)
    if (merging.panel_of(v) == v) {
      // A panel is where its last vertex is.
      number[v] = count();
      plan_.panels.push_back({});
    }
  panel_.resize(n);
  members_first_.assign(count() + 1, 0);
  for (Index v = 0; v < n; ++v) {
    panel_[v] = number[merging.panel_of(v)];
    ++members_first_[panel_[v] + 1];
  }
  // Counts to places, then each vertex into its place.
  std::partial_sum(members_first_.begin(), members_first_.end(), members_first_.begin());
  members_.resize(n);
  Indices next = members_first_;
  for (Index v = 0; v < n; ++v) members_[next[panel_[v]]++] = v;
}

/// Unknowns of L panel after panel, so that those of a panel are contiguous, and the tree of the panels. A
/// group keeps its unknowns side by side and in their order.
void Planner::number_unknowns() {
  plan_.to.resize(groups_.of.size());
  first_.resize(vertices_.count());
  Index unknowns = 0;
  for (Index p = 0; p < count(); ++p) {
    PanelAnalysis::Panel& here = plan_.panels[p];
    here.first = unknowns;
    for (const Index v : members_of(p)) {
      first_[v] = unknowns;
      for (Index k = 0; k < vertices_.size[v]; ++k)
        plan_.to[groups_.first[vertices_.order[v]] + k] = unknowns++;
    }
    here.width = unknowns - here.first;
    // The parent of a panel is the panel of the parent of its last vertex.
    const Index above = vertices_.parent[members_of(p).back()];
    here.parent = above < 0 ? -1 : panel_[above];
  }
}

/// Rows: the later neighbours of its own unknowns, and the rows of its children. By groups first, sorted by
/// their place in L. Each row so stands once in the list of each panel it passes on its way up the tree.
void Planner::find_rows() {
  std::vector<Indices> touched(count());
  for (Index p = 0; p < count(); ++p) {
    // The rows that children have handed on, and the later neighbours.
    Indices& mine = touched[p];
    for (const Index v : members_of(p))
      for (const Index u : vertices_.graph.of(v))
        if (panel_[u] > p) mine.push_back(u);
    std::ranges::sort(mine, {}, [&](Index v) { return first_[v]; });
    mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
    PanelAnalysis::Panel& here = plan_.panels[p];
    here.rows = plan_.rows.size();
    for (const Index v : mine)
      for (Index k = 0; k < vertices_.size[v]; ++k) plan_.rows.push_back(first_[v] + k);
    here.height = static_cast<Index>(plan_.rows.size() - here.rows);
    // Rows beyond the parent's own unknowns are rows of the parent too.
    if (here.parent >= 0)
      for (const Index v : mine)
        if (panel_[v] > here.parent) touched[here.parent].push_back(v);
    // No later panel asks for them: memory follows the front of the elimination, not the whole of L.
    mine = {};
  }
}

/// Where the numbers of each panel stand, and what all of them cost: column j of L, with m entries from its
/// diagonal down, m^2 operations, for m from height + 1 to height + width.
void Planner::place_values() {
  for (PanelAnalysis::Panel& here : plan_.panels) {
    const auto tall = static_cast<std::size_t>(PanelShape::padded(here.height));
    const auto wide = static_cast<std::size_t>(PanelShape::padded(here.width));
    // T, shape (padded width, width), then B, shape (padded height, width).
    here.values = plan_.values;
    plan_.values += (tall + wide) * static_cast<std::size_t>(here.width);
    plan_.tallest = std::max(plan_.tallest, here.height);
    plan_.widest = std::max(plan_.widest, here.width);
    plan_.work += squares(here.height, here.height + here.width);
  }
}

/// Where updates lie: on two stacks by turns, down the tree, which grow towards each other from the ends of
/// one array. While a panel writes its update those of its children are still read, and postorder frees
/// updates in the reverse order of their making.
void Planner::place_updates() {
  const auto size_of_update = [](const PanelAnalysis::Panel& panel) {
    return static_cast<std::size_t>(PanelShape::padded(panel.height)) *
           static_cast<std::size_t>(panel.height);
  };
  std::vector<PanelAnalysis::Panel>& panels = plan_.panels;
  // Depth in the tree: a panel and its children use different stacks.
  // eldest: the first child in postorder, whose update lies below those of its siblings.
  Indices depth(count(), 0), eldest(count(), -1);
  for (Index p = count(); p-- > 0;)
    if (panels[p].parent >= 0) depth[p] = depth[panels[p].parent] + 1;
  // How far each stack reaches, and did below the update of a panel.
  std::size_t top[2] = {};
  std::vector<std::size_t> below(panels.size());
  for (Index p = 0; p < count(); ++p) {
    const PanelAnalysis::Panel& here = panels[p];
    const Index stack = depth[p] % 2;
    below[p] = top[stack];
    top[stack] += size_of_update(here);
    plan_.updates = std::max(plan_.updates, top[0] + top[1]);
    // The updates of the children are used up: their stack falls to where the eldest began.
    if (eldest[p] >= 0) top[1 - stack] = below[eldest[p]];
    if (here.parent >= 0 && eldest[here.parent] < 0) eldest[here.parent] = p;
  }
  for (Index p = 0; p < count(); ++p)
    panels[p].update = depth[p] % 2 == 0 ? below[p] : plan_.updates - below[p] - size_of_update(panels[p]);
}

/// Where rows stand in parents. A panel without a parent has no rows and keeps three equal ends.
void Planner::join_rows() {
  for (PanelAnalysis::Panel& here : plan_.panels) {
    here.joins[0] = here.joins[1] = here.joins[2] = plan_.joins.size();
    if (here.parent >= 0) join_rows_of(here);
  }
}

/// Writes the runs of one panel: to unknowns of the parent while the row is below `end`, then to its rows.
void Planner::join_rows_of(PanelAnalysis::Panel& here) {
  const Indices& rows = plan_.rows;
  std::vector<PanelAnalysis::Run>& joins = plan_.joins;
  const PanelAnalysis::Panel& above = plan_.panels[here.parent];
  const Index end = above.first + above.width;
  // Rows ascend on both sides, so one pass over the rows of the parent finds all.
  std::size_t at = above.rows;
  bool inside = true;
  for (Index k = 0; k < here.height; ++k) {
    const Index row = rows[here.rows + k];
    if (inside && row >= end) {
      inside = false;
      here.joins[1] = joins.size();
    }
    if (!inside)
      while (rows[at] != row) ++at;
    const std::size_t place = inside ? static_cast<std::size_t>(row - above.first) : at - above.rows;
    const bool begins = joins.size() == here.joins[inside ? 0 : 1];
    // A run goes on where the next row stands next to the last one.
    if (!begins && joins.back().to + joins.back().length == place)
      ++joins.back().length;
    else
      joins.push_back({k, 1, place});
  }
  here.joins[2] = joins.size();
  if (inside) here.joins[1] = here.joins[2];
}

/// Entries of A: each column of an unknown, at the unknown itself and those eliminated later. One array
/// row_at serves all panels: each panel overwrites the places that it reads, so nothing is cleared.
void Planner::place_entries() {
  Indices row_at(plan_.to.size(), 0);  // of each unknown of L among the rows of the panel at hand
  for (Index p = 0; p < count(); ++p) {
    PanelAnalysis::Panel& here = plan_.panels[p];
    here.entries = plan_.entries.size();
    for (Index k = 0; k < here.height; ++k) row_at[plan_.rows[here.rows + k]] = k;
    place_entries_of(p, row_at);
  }
}

/// Writes the runs of the columns of one panel. Places are counted in `values`: T by columns of padded width,
/// then B, from `below` on, by columns of padded height. Rows of earlier unknowns are left out: they stand in
/// the columns of those, A being symmetric.
/// @param row_at  of an unknown of L that is a row of the panel: its number among the rows
void Planner::place_entries_of(Index p, const Indices& row_at) {
  const PanelAnalysis::Panel& here = plan_.panels[p];
  const auto tall = static_cast<std::size_t>(PanelShape::padded(here.height));
  const auto wide = static_cast<std::size_t>(PanelShape::padded(here.width));
  const std::size_t below = here.values + wide * static_cast<std::size_t>(here.width);
  for (const Index v : members_of(p))
    for (Index k = 0; k < vertices_.size[v]; ++k) {
      const Index j = groups_.first[vertices_.order[v]] + k;
      const auto column = static_cast<std::size_t>(plan_.to[j] - here.first);
      // Entries of one group of rows are contiguous in A and in the panel.
      for (Index from = outer_[j]; from < outer_[j + 1];) {
        const Index group = groups_.of[inner_[from]], length = groups_.size(group);
        const Index row = plan_.to[groups_.first[group]];
        // A group is on one side as a whole: its first unknown decides.
        if (row >= here.first + here.width)
          plan_.entries.push_back(
              {from, length, below + column * tall + static_cast<std::size_t>(row_at[row])});
        else if (row >= first_[v])
          plan_.entries.push_back(
              {from, length, here.values + column * wide + static_cast<std::size_t>(row - here.first)});
        from += length;
      }
    }
}

}  // namespace

/// The sequence is that of need: panels, their unknowns, their rows, then the places of numbers.
PanelAnalysis::PanelAnalysis(std::span<const Index> outer, std::span<const Index> inner) {
  Planner planner(*this, outer, inner);
  planner.gather_panels();
  planner.number_unknowns();
  planner.find_rows();
  planner.place_values();
  planner.place_updates();
  planner.join_rows();
  planner.place_entries();
}

}  // namespace hmax
