/// The mesh of an .inp file: *NODE, *ELEMENT of type C3D4, *NSET, *ELSET, *SOLID SECTION and *BOUNDARY. What
/// has no bearing on it is passed over.
#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

#include "problems/mesh/files/mesh_readers.hpp"
#include "problems/mesh/files/scenes/inp_file.hpp"

namespace hmax {

namespace {

/// Keywords that make or move points and elements in ways that are not read.
constexpr std::array<std::string_view, 10> unread{"INCLUDE", "PART",  "INSTANCE", "ASSEMBLY", "NGEN",
                                                  "NFILL",   "NCOPY", "ELGEN",    "ELCOPY",   "SYSTEM"};

class InpMeshReader {
 public:
  explicit InpMeshReader(const InpFile& file) : file_(file) {}

  InpMesh read() {
    for (const InpCard& card : file_.cards())
      if (std::ranges::find(unread, card.keyword) != unread.end())
        file_.fail(card.place, "*" + card.keyword + " is not read; write its points and elements out, as " +
                                   "one part, and export the file again");
    each("NODE", [&](const InpCard& card) { read_nodes(card); });
    builder_.number_points(file_.text());
    each("ELEMENT", [&](const InpCard& card) { read_elements(card); });
    find_elements();
    each("NSET", [&](const InpCard& card) {
      read_set(card, "NSET", nodes_, [&](std::int64_t n, std::int64_t place) { return point(n, place); });
    });
    each("ELSET", [&](const InpCard& card) {
      read_set(card, "ELSET", elements_,
               [&](std::int64_t n, std::int64_t place) { return element(n, place); });
    });
    set_regions();
    set_groups();
    result_.mesh = builder_.finish(file_.text(), "CalculiX/Abaqus");
    result_.element_sets = std::move(elements_);
    return std::move(result_);
  }

 private:
  using Set = std::vector<std::size_t>;

  template <class Read>
  void each(std::string_view keyword, Read read) {
    for (const InpCard& card : file_.cards())
      if (card.keyword == keyword) read(card);
  }

  std::size_t point(std::int64_t number, std::int64_t place) const {
    MeshText there = file_.text();
    there.about(place);
    return static_cast<std::size_t>(builder_.numbered_point(number, there, place, "line"));
  }

  std::size_t element(std::int64_t number, std::int64_t place) const {
    const auto found =
        std::ranges::lower_bound(by_number_, number, {}, &std::pair<std::int64_t, std::size_t>::first);
    if (found == by_number_.end() || found->first != number)
      file_.fail(place, "there is no element " + std::to_string(number) +
                            "; correct the set, or export the file again");
    return found->second;
  }

  const Set& set(const std::map<std::string, Set>& sets, const std::string& name, const char* what,
                 std::int64_t place) const {
    const auto found = sets.find(upper(name));
    if (found == sets.end())
      file_.fail(place, std::string("there is no ") + what + " " + in_quotes(name) +
                            "; define it, or correct the name");
    return found->second;
  }

  void read_nodes(const InpCard& card) {
    Set& named = nodes_[card.parameter("NSET").value_or("")];
    for (const InpLine& line : card.lines) {
      named.push_back(builder_.point_count());
      const std::int64_t number = file_.integer(line, 0, "the number of a node");
      const double x = file_.number(line, 1, "x coordinate"), y = file_.number(line, 2, "y coordinate");
      builder_.add_point(number, x, y, file_.number(line, 3, "z coordinate"));
    }
  }

  void read_elements(const InpCard& card) {
    const std::string type = card.parameter("TYPE").value_or("");
    if (type != "C3D4")
      file_.fail(card.place, "the elements are of type " + in_quotes(type) +
                                 ", and only C3D4 is read; mesh the body with tetrahedra of four nodes");
    const auto named = card.parameter("ELSET");
    if (named && std::ranges::find(element_cards_, *named) == element_cards_.end())
      element_cards_.push_back(*named);
    for (const InpLine& line : card.lines) {
      const std::int64_t number = file_.integer(line, 0, "the number of an element");
      std::array<TetMesh::Index, 4> corners{};
      for (std::size_t k = 0; k < 4; ++k)
        corners[k] =
            static_cast<TetMesh::Index>(point(file_.integer(line, k + 1, "node of an element"), line.place));
      if (line.fields.size() > 5)
        file_.fail(line.place,
                   "element " + std::to_string(number) + " has more than four nodes; export the file again");
      by_number_.emplace_back(number, builder_.tetrahedron_count());
      if (named) elements_[*named].push_back(builder_.tetrahedron_count());
      builder_.add_tetrahedron(corners, number, line.place, 0, file_.text());
    }
  }

  void find_elements() {
    std::ranges::sort(by_number_);
    const auto twice =
        std::ranges::adjacent_find(by_number_, {}, &std::pair<std::int64_t, std::size_t>::first);
    if (twice != by_number_.end())
      throw std::invalid_argument(file_.text().name() + ": element " + std::to_string(twice->first) +
                                  " is given twice; remove one of them");
  }

  /// Numbers and names of sets before it, or, with GENERATE, "first, last, step".
  template <class Find>
  void read_set(const InpCard& card, const char* parameter, std::map<std::string, Set>& sets,
                const Find& find) {
    const auto name = card.parameter(parameter);
    if (!name || name->empty())
      file_.fail(card.place, "the set has no name; write *" + card.keyword + ", " + parameter + "=NAME");
    Set more = sets[*name];
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
        const Set& other = set(sets, std::string(line.fields[k]), "set", line.place);
        more.insert(more.end(), other.begin(), other.end());
      }
    }
    sets[*name] = std::move(more);
  }

  static bool is_number(std::string_view word) {
    return !word.empty() &&
           (word.front() == '-' || word.front() == '+' || (word.front() >= '0' && word.front() <= '9'));
  }

  void set_regions() {
    std::int64_t region = 0;
    std::vector<char> taken(builder_.tetrahedron_count(), 0);
    each("SOLID SECTION", [&](const InpCard& card) {
      result_.sections.push_back(&card);
      const std::string name = card.parameter("ELSET").value_or("");
      builder_.name_group(3, ++region, name, file_.text());
      for (const std::size_t t : set(elements_, name, "element set", card.place)) {
        if (std::exchange(taken[t], 1) != 0)
          file_.fail(card.place, "an element of the set " + in_quotes(name) +
                                     " has a *SOLID SECTION already; keep one of them");
        builder_.set_region(t, region, file_.text());
      }
    });
    if (!result_.sections.empty()) {
      if (const auto none = std::ranges::find(taken, 0); none != taken.end())
        file_.fail(result_.sections.front()->place, std::to_string(std::ranges::count(taken, 0)) +
                                                        " elements are in no *SOLID SECTION; give them one");
      return;
    }
    for (const std::string& name : element_cards_) {
      builder_.name_group(3, ++region, name, file_.text());
      for (const std::size_t t : elements_[name]) builder_.set_region(t, region, file_.text());
    }
  }

  /// The directions of a line of *BOUNDARY as bits 0 to 2; bit 3: held in a way that is not read.
  unsigned directions(const InpLine& line) const {
    constexpr unsigned unknown = 8;
    if (line.fields.size() < 2) return unknown;
    const std::string word = upper(line.fields[1]);
    if (word == "ENCASTRE" || word == "PINNED") return 7;
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

  void set_groups() {
    std::vector<unsigned> held(builder_.point_count(), 0);
    each("BOUNDARY", [&](const InpCard& card) {
      for (const InpLine& line : card.lines) {
        const unsigned bits = directions(line);
        if (!line.fields.empty() && is_number(line.fields[0]))
          held[point(file_.integer(line, 0, "node"), line.place)] |= bits;
        else
          for (const std::size_t i :
               set(nodes_, std::string(line.fields.empty() ? "" : line.fields[0]), "node set", line.place))
            held[i] |= bits;
      }
    });
    nodes_.erase("");
    for (std::size_t i = 0; i < held.size(); ++i)
      if (held[i] != 0) nodes_[std::string(held[i] == 7 ? held_points : otherwise_held_points)].push_back(i);
    std::int64_t number = 0;
    for (const auto& [name, points] : nodes_) {
      builder_.name_group(0, ++number, name, file_.text());
      for (const std::size_t i : points)
        builder_.add_to_group(number, std::array{static_cast<TetMesh::Index>(i)});
    }
  }

  const InpFile& file_;
  InpMesh result_;
  MeshBuilder builder_;
  std::vector<std::pair<std::int64_t, std::size_t>> by_number_;
  std::map<std::string, Set> nodes_, elements_;
  std::vector<std::string> element_cards_;
};

}  // namespace

InpMesh inp_mesh(const InpFile& file) { return InpMeshReader(file).read(); }

MeshFile read_inp(const std::string& name, std::string_view text) {
  return inp_mesh(InpFile(name, text)).mesh;
}

}  // namespace hmax
