/// The mesh of an .inp file: *NODE, *ELEMENT of types C3D4 and C3D10, *NSET, *ELSET, *SOLID SECTION and
/// *BOUNDARY. What has no bearing on it is passed over.
#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <unordered_map>
#include <utility>

#include "problems/mesh/files/mesh_readers.hpp"
#include "problems/mesh/files/scenes/inp_file.hpp"

namespace hmax {

namespace {

/// Keywords that make or move points and elements in ways that are not read.
constexpr std::array<std::string_view, 6> unread{"NGEN", "NFILL", "NCOPY", "ELGEN", "ELCOPY", "SYSTEM"};

/// The parameters of keywords that make points, elements and sets, as lists.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> known_parameters{
    {{"NODE", "NSET|SYSTEM"},
     {"ELEMENT", "TYPE|ELSET"},
     {"NSET", "NSET|ELSET|GENERATE|INSTANCE|INTERNAL|UNSORTED"},
     {"ELSET", "ELSET|GENERATE|INSTANCE|INTERNAL|UNSORTED"}}};

class InpMeshReader {
 public:
  explicit InpMeshReader(const InpFile& file) : file_(file) {}

  InpMesh read() {
    for (const InpCard& card : file_.cards())
      if (std::ranges::find(unread, card.keyword) != unread.end())
        file_.fail(card.place,
                   "*" + card.keyword +
                       " is not read; write its points and elements out, and export the file again");
    for (const auto& [keyword, parameters] : known_parameters)
      each(keyword, [&, known = parameters](const InpCard& card) { require_known(card, known); });
    each("NODE", [&](const InpCard& card) { read_nodes(card); });
    builder_.number_points(whole_);
    each("ELEMENT", [&](const InpCard& card) { read_elements(card); });
    each("ELSET", [&](const InpCard& card) {
      read_set(card, elements_, [&](std::int64_t n, std::int64_t place) { return element(n, place); });
    });
    each("NSET", [&](const InpCard& card) {
      read_set(card, nodes_, [&](std::int64_t n, std::int64_t place) { return point(n, place); });
    });
    set_regions();
    set_groups();
    result_.mesh = builder_.finish(whole_, "CalculiX/Abaqus");
    for (std::int64_t& place : result_.mesh.places) place = file_.own_line(place);
    each("MATERIAL", [&](const InpCard& card) {
      if (std::string& first = result_.mesh.material; first.empty())
        first = place_in_words(file_.at(card.place).name(), file_.line(card.place), false);
    });
    result_.element_sets = std::move(elements_);
    return std::move(result_);
  }

 private:
  using Set = std::vector<std::size_t>;
  using Sets = std::map<std::string, Set>;
  using ElementCard = std::pair<std::string, const InpCard*>;  ///< by its set

  /// Others would change the mesh.
  void require_known(const InpCard& card, std::string_view known) const {
    if (const std::string* const other = card.unknown_parameter(known))
      file_.fail(card.place, *other + " of *" + card.keyword +
                                 " is not read; write its lines without it, or export the file again");
  }

  template <class Read>
  void each(std::string_view keyword, Read read) {
    for (const InpCard& card : file_.cards())
      if (card.keyword == keyword) read(card);
  }

  std::size_t point(std::int64_t number, std::int64_t place) const {
    return static_cast<std::size_t>(
        builder_.numbered_point(number, file_.at(place), file_.line(place), "line"));
  }

  std::size_t element(std::int64_t number, std::int64_t place) const {
    const auto found = by_number_.find(number);
    if (found == by_number_.end())
      file_.fail(place, "there is no element " + std::to_string(number) +
                            "; correct the set, or export the file again");
    return found->second;
  }

  /// A name that is given in the part as it is called from outside.
  std::string scoped(const InpCard& card, std::string_view name) const {
    return (card.is_in_part ? file_.prefix() : "") + upper(name);
  }

  const Set& set(const Sets& sets, std::string_view name, const InpCard& card, std::int64_t place) const {
    const auto found = sets.find(scoped(card, name));
    if (found == sets.end())
      file_.fail(place, std::string("there is no ") + (&sets == &nodes_ ? "node" : "element") + " set " +
                            in_quotes(name) + "; define it, or correct the name");
    return found->second;
  }

  void read_nodes(const InpCard& card) {
    const auto its = card.parameter("NSET");
    Set& named = nodes_[its ? scoped(card, *its) : ""];
    for (const InpLine& line : card.lines) {
      named.push_back(builder_.point_count());
      const std::int64_t number = file_.integer(line, 0, "the number of a node");
      const double x = file_.number(line, 1, "x coordinate"), y = file_.number(line, 2, "y coordinate");
      builder_.add_point(number, x, y, file_.number(line, 3, "z coordinate"));
    }
  }

  void read_elements(const InpCard& card) {
    const std::string type = card.parameter("TYPE").value_or("");
    const bool has_middles = type == "C3D10";
    const std::size_t count = has_middles ? 10 : 4;
    if (type != "C3D4" && !has_middles)
      file_.fail(card.place, "the elements are of type " + in_quotes(type) +
                                 ", and only C3D4 and C3D10 are read; mesh the body with tetrahedra");
    const auto named = card.parameter("ELSET");
    if (named && element_names_.insert(*named).second) element_cards_.emplace_back(*named, &card);
    for (std::size_t next = 0; next < card.lines.size();) {
      InpLine line = card.lines[next++];
      for (; line.goes_on && line.fields.size() <= count && next < card.lines.size(); ++next) {
        const InpLine& more = card.lines[next];
        line.fields.insert(line.fields.end(), more.fields.begin(), more.fields.end());
        line.goes_on = more.goes_on;
      }
      const std::int64_t number = file_.integer(line, 0, "the number of an element");
      std::array<TetMesh::Index, 10> points{};
      for (std::size_t k = 0; k < count; ++k)
        points[k] =
            static_cast<TetMesh::Index>(point(file_.integer(line, k + 1, "node of an element"), line.place));
      if (line.fields.size() > count + 1)
        file_.fail(line.place, "element " + std::to_string(number) + " has more than " +
                                   (has_middles ? "ten" : "four") + " nodes; export the file again");
      if (!by_number_.emplace(number, builder_.tetrahedron_count()).second)
        file_.fail(line.place, "element " + std::to_string(number) + " is given twice; remove one of them");
      if (named) elements_[scoped(card, *named)].push_back(builder_.tetrahedron_count());
      points_.emplace_back(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count));
      builder_.add_tetrahedron({points[0], points[1], points[2], points[3]}, number, line.place, 0, whole_);
      if (has_middles) builder_.add_middles(std::span(points).last<6>(), middles_of_vtk);
    }
  }

  /// Numbers and names of sets before it, or, with GENERATE, "first, last, step"; or the points of the
  /// elements of a set.
  template <class Find>
  void read_set(const InpCard& card, Sets& sets, const Find& find) {
    const std::string name = card.parameter(card.keyword).value_or("");
    if (name.empty())
      file_.fail(card.place, "the set has no name; write *" + card.keyword + ", " + card.keyword + "=NAME");
    if (const auto instance = card.parameter("INSTANCE"); instance && *instance + "." != file_.prefix())
      file_.fail(card.place, "there is no *INSTANCE " + in_quotes(*instance) + "; correct the name");
    Set more = sets[scoped(card, name)];
    if (const auto of = card.parameter("ELSET"); of && card.keyword == "NSET")
      for (const std::size_t t : set(elements_, *of, card, card.place))
        more.insert(more.end(), points_[t].begin(), points_[t].end());
    for (const InpLine& line : card.lines) {
      if (card.parameter("GENERATE")) {
        const std::int64_t last = file_.integer(line, 1, "last number");
        const std::int64_t step = line.fields.size() > 2 ? file_.integer(line, 2, "step") : 1;
        if (step < 1)
          file_.fail(line.place, "the step of a set is " + std::to_string(step) + " but must be positive");
        for (std::int64_t n = file_.integer(line, 0, "first number"); n <= last; n += step) {
          more.push_back(find(n, line.place));
          if (n > last - step) break;  // before it overflows
        }
        continue;
      }
      for (std::size_t k = 0; k < line.fields.size(); ++k) {
        if (is_number(line.fields[k])) {
          more.push_back(find(file_.integer(line, k, "member of a set"), line.place));
          continue;
        }
        const Set& other = set(sets, line.fields[k], card, line.place);
        more.insert(more.end(), other.begin(), other.end());
      }
    }
    std::ranges::sort(more);
    more.erase(std::unique(more.begin(), more.end()), more.end());
    sets[scoped(card, name)] = std::move(more);
  }

  static bool is_number(std::string_view word) { return word.find_first_of("+-0123456789") == 0; }

  void set_regions() {
    each("SOLID SECTION", [&](const InpCard& card) { result_.sections.push_back(&card); });
    std::int64_t region = 0;
    if (result_.sections.empty())
      for (const auto& [name, card] : element_cards_) set_region(++region, name, *card);
    std::vector<char> taken(builder_.tetrahedron_count(), 0);
    for (const InpCard* card : result_.sections) {
      const std::string name = card->parameter("ELSET").value_or("");
      for (const std::size_t t : set(elements_, name, *card, card->place))
        if (std::exchange(taken[t], 1) != 0)
          file_.fail(card->place, "an element of the set " + in_quotes(name) +
                                      " has a *SOLID SECTION already; keep one of them");
      set_region(++region, name, *card);
    }
    if (const auto none = std::ranges::count(taken, 0); !result_.sections.empty() && none > 0)
      file_.fail(result_.sections.front()->place,
                 std::to_string(none) + " elements are in no *SOLID SECTION; give them one");
  }

  void set_region(std::int64_t region, const std::string& name, const InpCard& card) {
    builder_.name_group(3, region, name, whole_);
    for (const std::size_t t : elements_[scoped(card, name)]) builder_.set_region(t, region, whole_);
  }

  static constexpr unsigned all = 7, unknown = 8;

  /// The directions of a line of *BOUNDARY as bits 0 to 2; bit 3: held in a way that is not read.
  unsigned directions(const InpLine& line) const {
    if (line.fields.size() < 2) return unknown;
    const std::string word = upper(line.fields[1]);
    if (word == "ENCASTRE" || word == "PINNED") return all;
    for (unsigned d = 0; d < 3; ++d)
      if (word == std::string(1, "XYZ"[d]) + "SYMM") return 1U << d;
    if (!is_number(word)) return unknown;
    const std::int64_t first = file_.integer(line, 1, "first direction");
    const bool has_last = line.fields.size() > 2 && !line.fields[2].empty();
    const std::int64_t last = has_last ? file_.integer(line, 2, "last direction") : first;
    const double value =
        line.fields.size() > 3 && !line.fields[3].empty() ? file_.number(line, 3, "value") : 0;
    if (first < 1 || last < first || last > 6 || value != 0) return unknown;
    unsigned bits = 0;
    // Solids have no rotations, 4 to 6.
    for (std::int64_t d = first; d <= std::min<std::int64_t>(last, 3); ++d) bits |= 1U << (d - 1);
    return bits;
  }

  /// Of the number or the set that a line begins with.
  Set points_of(const InpLine& line, const InpCard& card) const {
    const std::string name = line.fields.empty() ? "" : upper(line.fields[0]);
    if (name.empty()) file_.fail(line.place, "the line names no node and no set; write one first");
    if (is_number(name)) return {point(file_.integer(line, 0, "node"), line.place)};
    if (const std::string& prefix = file_.prefix(); !prefix.empty() && name.starts_with(prefix) &&
                                                    is_number(std::string_view(name).substr(prefix.size()))) {
      const std::string number = name.substr(prefix.size());
      return {point(file_.integer({.place = line.place, .fields = {number}}, 0, "node"), line.place)};
    }
    return set(nodes_, name, card, line.place);
  }

  void set_groups() {
    std::vector<unsigned> held(builder_.point_count(), 0);
    std::vector<const InpLine*> by(held.size(), nullptr);
    each("BOUNDARY", [&](const InpCard& card) {
      const bool is_known = !card.unknown_parameter(boundary_parameters);
      for (const InpLine& line : card.lines) {
        const unsigned bits = is_known ? directions(line) : unknown;
        for (const std::size_t i : points_of(line, card)) {
          if (!by[i] || bits == unknown) by[i] = &line;
          held[i] |= bits;
        }
      }
    });
    nodes_.erase("");
    for (std::size_t i = 0; i < held.size(); ++i) {
      if ((held[i] & all) == all) nodes_[std::string(held_points)].push_back(i);
      if (held[i] == 0 || held[i] == all) continue;
      nodes_[std::string(otherwise_held_points)].push_back(i);
      if (!result_.otherwise_held) result_.otherwise_held = by[i];
    }
    std::int64_t number = 0;
    for (const auto& [name, points] : nodes_) {
      builder_.name_group(0, ++number, name, whole_);
      for (const std::size_t i : points)
        builder_.add_to_group(number, std::array{static_cast<TetMesh::Index>(i)});
    }
  }

  const InpFile& file_;
  MeshText whole_ = file_.at(-1);
  InpMesh result_;
  MeshBuilder builder_;
  std::unordered_map<std::int64_t, std::size_t> by_number_;
  Sets nodes_, elements_;
  std::vector<ElementCard> element_cards_;
  std::set<std::string> element_names_;              ///< of these
  std::vector<std::vector<TetMesh::Index>> points_;  ///< of the elements
};

}  // namespace

InpMesh inp_mesh(const InpFile& file) { return InpMeshReader(file).read(); }

MeshFile read_inp(const std::string& name, std::string_view text) {
  return inp_mesh(InpFile(name, text)).mesh;
}

}  // namespace hmax
