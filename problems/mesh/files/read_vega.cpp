/// VegaFEM's .veg, ASCII [sin2013vega]: vertices and elements count from 0 or from 1 as their numbers say,
/// and *REGION gives sets of elements their materials. *INCLUDE puts another file in its place, also a list
/// of TetGen.
#include <algorithm>
#include <charconv>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>

#include "core/process/whole_file.hpp"
#include "problems/mesh/files/mesh_file.hpp"
#include "problems/mesh/files/mesh_readers.hpp"

namespace hmax {

namespace {

class VegaReader {
 public:
  VegaReader(const std::string& name, std::string_view bytes) {
    std::error_code ignored;
    sources_.push_back({.bytes = nullptr,
                        .text = {name, bytes, '#'},
                        .path = std::filesystem::weakly_canonical(name, ignored)});
  }

  MeshFile read() {
    if (!text().peek().starts_with("*"))
      text().fail("a Vega file begins with a section such as *VERTICES and not with " +
                  in_quotes(text().peek()) + "; export the mesh again or correct the extension");
    while (!at_end()) read_section();
    text().require_end(false);
    set_regions();
    MeshFile file = builder_.finish(text(), "Vega");
    file.material = material_;
    return file;
  }

 private:
  struct Region {
    std::string set;
    std::int64_t place;
  };

  /// A file that is being read.
  struct Source {
    std::unique_ptr<std::string> bytes;  ///< null of the first one, which the caller holds
    MeshText text;
    std::filesystem::path path;
    std::int64_t included_at = 0;  ///< the line that includes it
  };

  MeshText& text() { return sources_.back().text; }

  /// The line of the first file where the next word stands, or where a file with it is included.
  std::int64_t place() { return sources_.size() > 1 ? sources_[1].included_at : text().place(); }

  /// Goes into the file that is included here, and out of those that end here. Called between lines.
  void settle() {
    while (true) {
      if (text().at_end()) {
        if (sources_.size() == 1) return;
        text().require_end(false);
        sources_.pop_back();
      } else if (same_keyword(text().peek(), "*INCLUDE")) {
        include();
      } else {
        return;
      }
    }
  }

  void include() {
    // As many as a file can hold that somebody wrote.
    constexpr std::size_t deepest = 16, most = 1000;
    const std::int64_t line = text().place();
    text().begin_line();
    text().word("*INCLUDE");
    const std::string name(text().word("the name of a file"));
    const auto fail = [&](const std::string& why) {
      text().fail("the file includes " + in_quotes(name) + ", " + why);
    };
    std::error_code ignored;
    const std::filesystem::path folder = std::filesystem::path(sources_.front().text.name()).parent_path();
    const std::filesystem::path path = folder / name,
                                whole = std::filesystem::weakly_canonical(path, ignored);
    if (!std::filesystem::is_regular_file(path, ignored))
      fail("but there is no such file beside it; put it there or its text here");
    if (std::ranges::any_of(sources_, [&](const Source& source) { return source.path == whole; }))
      fail("which includes it again; put its text here instead");
    if (sources_.size() > deepest)
      fail("the " + std::to_string(deepest + 1) + "th file in one another, and " + std::to_string(deepest) +
           " may be; put its text here instead");
    if (++included_ > most)
      fail("but " + std::to_string(most) +
           " files are included before it, which are the most; put its text here instead");
    text().end_line("*INCLUDE");
    auto bytes = std::make_unique<std::string>(read_whole(path, "a mesh file"));
    MeshText inner(path.string(), *bytes, '#');
    sources_.push_back(
        {.bytes = std::move(bytes), .text = std::move(inner), .path = whole, .included_at = line});
  }

  bool at_end() {
    settle();
    return text().at_end();
  }

  /// True where a list goes on, and false before the next section.
  bool in_list() { return !at_end() && !text().peek().starts_with("*"); }

  void begin_line() {
    settle();
    text().begin_line();
  }

  void read_section() {
    const std::string section(text().word("a section"));
    if (same_keyword(section, "*VERTICES")) {
      read_vertices();
    } else if (same_keyword(section, "*ELEMENTS")) {
      read_elements();
    } else if (same_keyword(section, "*SET")) {
      read_set();
    } else if (same_keyword(section, "*REGION")) {
      text().line();
      const std::int64_t where = place();
      const std::vector<std::string> parts = list();
      if (parts.size() != 2)
        text().fail("a region is 'SET, MATERIAL' and not " + std::to_string(parts.size()) +
                    " words; export the mesh again");
      regions_.push_back({parts[0], where});
    } else if (same_keyword(section, "*MATERIAL")) {
      // Materials of a body are for --set and --material to say.
      if (material_.empty()) material_ = place_in_words(text().name(), text().place(), false);
      if (list().size() < 2)
        text().fail("a material has no values; the file is cut off, so copy or export it again");
    } else {
      text().fail("a section such as *ELEMENTS should be here and not " + in_quotes(section) +
                  "; a count before it is wrong, so export the mesh again");
    }
  }

  void read_vertices() {
    if (builder_.point_count() > 0) text().fail("there are two sections *VERTICES; export the mesh again");
    begin_line();
    const std::size_t count = text().count("vertices", 8);
    if (const std::int64_t dimension = text().integer("the dimension"); dimension != 3)
      text().fail("the vertices have " + std::to_string(dimension) + " coordinates; a body needs 3");
    text().skip_rest_of_line();
    builder_.reserve_points(count);
    ExtraColumns behind;
    for (std::size_t i = 0; i < count; ++i) {
      begin_line();
      const std::int64_t number = text().integer("the number of a vertex");
      const double x = text().number("the x coordinate"), y = text().number("the y coordinate");
      builder_.add_point(number, x, y, text().number("the z coordinate"));
      behind.skip(text(), "a vertex");
    }
    builder_.number_points(text());
  }

  void read_elements() {
    settle();
    if (const auto type = text().word("the type of elements"); !lower(type).starts_with("tet"))
      text().fail("the elements are of type " + in_quotes(type) + "; mesh the body with tetrahedra only");
    begin_line();
    const std::size_t count = text().count("tetrahedra", 10);
    if (const std::int64_t corners = text().integer("the number of vertices of an element"); corners != 4)
      text().fail("a tetrahedron has " + std::to_string(corners) +
                  " vertices instead of 4; export the mesh again");
    text().skip_rest_of_line();
    builder_.reserve_tetrahedra(count);
    ExtraColumns behind;
    for (std::size_t i = 0; i < count; ++i) {
      begin_line();
      const std::int64_t where = place(), number = text().integer("the number of an element");
      std::array<TetMesh::Index, 4> corners{};
      for (TetMesh::Index& corner : corners)
        corner = builder_.numbered_point(text().integer("a vertex of an element"), text(), number);
      if (!elements_.emplace(number, builder_.tetrahedron_count()).second)
        text().fail("element " + std::to_string(number) + " is given twice; remove one of them");
      behind.skip(text(), "an element");
      builder_.add_tetrahedron(corners, number, where, 0, text());
    }
  }

  void read_set() {
    const std::string name(text().word("the name of a set"));
    std::vector<std::size_t>& set = sets_[name];
    while (in_list()) {
      const std::int64_t where = text().place();
      for (const std::string& word : split(text().word("an element of a set"))) {
        std::int64_t number = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        const auto element = elements_.find(number);
        text().about(where);
        if (error != std::errc{} || end != word.data() + word.size() || element == elements_.end())
          text().fail("the set " + in_quotes(name) + " has " + in_quotes(word) +
                      ", which is no element before it; export the mesh again");
        text().about(-1);
        set.push_back(element->second);
      }
    }
    if (set.empty())
      text().fail("the set " + in_quotes(name) +
                  " has no elements; the file is cut off, so copy or export it again");
  }

  /// Regions have numbers from 1 and the names of their sets; where they overlap the last one counts.
  void set_regions() {
    std::int64_t number = 0;
    for (const auto& [name, where] : regions_) {
      ++number;
      text().about(where);
      builder_.name_group(3, number, name, text());
      if (const auto set = sets_.find(name); set != sets_.end()) {
        for (const std::size_t element : set->second) builder_.set_region(element, number, text());
      } else if (name == "allElements") {
        for (std::size_t i = 0; i < builder_.tetrahedron_count(); ++i) builder_.set_region(i, number, text());
      } else {
        text().fail("the region uses the set " + in_quotes(name) + ", which the file does not have; add it");
      }
    }
    text().about(-1);
  }

  /// The words up to the next section, with blanks or commas between them.
  std::vector<std::string> list() {
    std::vector<std::string> words;
    while (in_list())
      for (std::string& word : split(text().word(""))) words.push_back(std::move(word));
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

  std::deque<Source> sources_;  ///< the file, and those that it includes here
  std::size_t included_ = 0;
  std::string material_;
  MeshBuilder builder_;
  std::map<std::int64_t, std::size_t> elements_;  ///< by their numbers
  std::map<std::string, std::vector<std::size_t>> sets_;
  std::vector<Region> regions_;
};

}  // namespace

MeshFile read_vega(const std::string& name, std::string_view bytes) { return VegaReader(name, bytes).read(); }

}  // namespace hmax
