/// VegaFEM's .veg, ASCII [sin2013vega]: vertices and elements count from 0 or from 1 as their numbers say,
/// and *REGION gives sets of elements their materials.
#include <algorithm>
#include <charconv>
#include <map>

#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_readers.hpp"

namespace hmax {

namespace {

class VegaReader {
 public:
  VegaReader(const std::string& name, std::string_view bytes) : text_(name, bytes, '#') {}

  MeshFile read() {
    if (!text_.peek().starts_with("*"))
      text_.fail("a Vega file begins with a section such as *VERTICES and not with " +
                 in_quotes(text_.peek()) + "; export the mesh again or correct the extension");
    while (!text_.at_end()) read_section();
    text_.require_end();
    set_regions();
    return builder_.finish(text_, "Vega");
  }

 private:
  struct Region {
    std::string set;
    std::int64_t place;
  };

  void read_section() {
    const std::string section(text_.word("a section"));
    if (section == "*VERTICES") {
      read_vertices();
    } else if (section == "*ELEMENTS") {
      read_elements();
    } else if (section == "*SET") {
      read_set();
    } else if (section == "*REGION") {
      text_.line();
      const std::int64_t place = text_.place();
      const std::vector<std::string> parts = list();
      if (parts.size() != 2)
        text_.fail("a region is 'SET, MATERIAL' and not " + std::to_string(parts.size()) +
                   " words; export the mesh again");
      regions_.push_back({parts[0], place});
    } else if (section == "*INCLUDE") {
      text_.fail("the file includes another one; put its text here instead");
    } else if (section == "*MATERIAL") {
      // Materials of a body are for --set and --material to say.
      if (list().size() < 2)
        text_.fail("a material has no values; the file is cut off, so copy or export it again");
    } else {
      text_.fail("a section such as *ELEMENTS should be here and not " + in_quotes(section) +
                 "; a count before it is wrong, so export the mesh again");
    }
  }

  void read_vertices() {
    if (builder_.point_count() > 0) text_.fail("there are two sections *VERTICES; export the mesh again");
    text_.begin_line();
    const std::size_t count = text_.count("vertices", 8);
    if (const std::int64_t dimension = text_.integer("the dimension"); dimension != 3)
      text_.fail("the vertices have " + std::to_string(dimension) + " coordinates; a body needs 3");
    read_reserved("the counts of vertices");
    builder_.reserve_points(count);
    for (std::size_t i = 0; i < count; ++i) {
      text_.begin_line();
      const std::int64_t number = text_.integer("the number of a vertex");
      const double x = text_.number("the x coordinate"), y = text_.number("the y coordinate");
      builder_.add_point(number, x, y, text_.number("the z coordinate"));
      text_.end_line("a vertex");
    }
    builder_.number_points(text_);
  }

  void read_elements() {
    if (const auto type = text_.word("the type of elements"); !type.starts_with("TET"))
      text_.fail("the elements are of type " + in_quotes(type) + "; mesh the body with tetrahedra only");
    text_.begin_line();
    const std::size_t count = text_.count("tetrahedra", 10);
    if (const std::int64_t corners = text_.integer("the number of vertices of an element"); corners != 4)
      text_.fail("a tetrahedron has " + std::to_string(corners) +
                 " vertices instead of 4; export the mesh again");
    read_reserved("the counts of elements");
    builder_.reserve_tetrahedra(count);
    for (std::size_t i = 0; i < count; ++i) {
      text_.begin_line();
      const std::int64_t place = text_.place(), number = text_.integer("the number of an element");
      std::array<TetMesh::Index, 4> corners{};
      for (TetMesh::Index& corner : corners)
        corner = builder_.numbered_point(text_.integer("a vertex of an element"), text_, number);
      if (!elements_.emplace(number, builder_.tetrahedron_count()).second)
        text_.fail("element " + std::to_string(number) + " is given twice; remove one of them");
      text_.end_line("an element");
      builder_.add_tetrahedron(corners, number, place, 0, text_);
    }
  }

  /// The numbers at the end of a line of counts, which the format keeps for later use.
  void read_reserved(const char* what) {
    while (!text_.peek().empty()) text_.integer("a reserved number");
    text_.end_line(what);
  }

  void read_set() {
    const std::string name(text_.word("the name of a set"));
    std::vector<std::size_t>& set = sets_[name];
    while (!text_.at_end() && !text_.peek().starts_with("*")) {
      const std::int64_t place = text_.place();
      for (const std::string& word : split(text_.word("an element of a set"))) {
        std::int64_t number = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        const auto element = elements_.find(number);
        text_.about(place);
        if (error != std::errc{} || end != word.data() + word.size() || element == elements_.end())
          text_.fail("the set " + in_quotes(name) + " has " + in_quotes(word) +
                     ", which is no element before it; export the mesh again");
        text_.about(-1);
        set.push_back(element->second);
      }
    }
    if (set.empty())
      text_.fail("the set " + in_quotes(name) +
                 " has no elements; the file is cut off, so copy or export it again");
  }

  /// Regions have numbers from 1 and the names of their sets; where they overlap the last one counts.
  void set_regions() {
    std::int64_t number = 0;
    for (const auto& [name, place] : regions_) {
      ++number;
      text_.about(place);
      builder_.name_group(3, number, name, text_);
      if (const auto set = sets_.find(name); set != sets_.end()) {
        for (const std::size_t element : set->second) builder_.set_region(element, number, text_);
      } else if (name == "allElements") {
        for (std::size_t i = 0; i < builder_.tetrahedron_count(); ++i) builder_.set_region(i, number, text_);
      } else {
        text_.fail("the region uses the set " + in_quotes(name) + ", which the file does not have; add it");
      }
    }
    text_.about(-1);
  }

  /// The words up to the next section, with blanks or commas between them.
  std::vector<std::string> list() {
    std::vector<std::string> words;
    while (!text_.at_end() && !text_.peek().starts_with("*"))
      for (std::string& word : split(text_.word(""))) words.push_back(std::move(word));
    return words;
  }

  static std::vector<std::string> split(std::string_view text) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size();) {
      const std::size_t end = std::min(text.find(',', begin), text.size());
      if (end > begin) parts.emplace_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
    return parts;
  }

  MeshText text_;
  MeshBuilder builder_;
  std::map<std::int64_t, std::size_t> elements_;  ///< by their numbers
  std::map<std::string, std::vector<std::size_t>> sets_;
  std::vector<Region> regions_;
};

}  // namespace

MeshFile read_vega(const std::string& name, std::string_view bytes) { return VegaReader(name, bytes).read(); }

}  // namespace hmax
