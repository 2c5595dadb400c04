#include "addons/fmi/unit_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <minizip/unzip.h>
#include <string_view>
#include <sys/stat.h>

#include "problems/mesh/files/scenes/xml_file.hpp"

namespace hmax::fmi {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t most_bytes = 1'000'000'000;
constexpr int most_files = 10'000;
constexpr const char* again = "; export it again";

/// @param code  of a call of minizip
void require_whole(int code) {
  if (code < 0) throw Failure{std::string("the archive (zip) is damaged or none") + again};
}

void write(unzFile zip, const fs::path& file, std::int64_t& left) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  std::array<char, 65536> block;
  require_whole(unzOpenCurrentFile(zip));
  const auto read = [&] { return unzReadCurrentFile(zip, block.data(), block.size()); };
  for (int count = read(); count != 0; count = read()) {
    require_whole(count);
    left -= count;
    if (left < 0) throw Failure{"its files have more than 1 GB"};
    out.write(block.data(), count);
  }
  require_whole(unzCloseCurrentFile(zip));
  if (!out.flush())
    throw Failure{"'" + file.string() + "' cannot be written; set TMPDIR to a place with room"};
}

/// The name of the entry that minizip is at; empty where nothing is to be unpacked.
std::string name_of_entry(unzFile zip) {
  std::array<char, 4096> text{};
  unz_file_info64 info{};
  require_whole(unzGetCurrentFileInfo64(zip, &info, text.data(), text.size() - 1, nullptr, 0, nullptr, 0));
  std::string name = text.data();
  const fs::path path = name;
  if (info.size_filename != name.size() || path.is_absolute() || std::ranges::find(path, "..") != path.end())
    throw Failure{"its entry '" + name + "' would lie outside of it" + again};
  const bool needed = name == "modelDescription.xml" || name.starts_with("binaries/linux64/") ||
                      name.starts_with("resources/");
  if (!needed || name.ends_with('/')) return {};
  // The mode of the file, where the archive was made on a system that has them.
  const auto mode = static_cast<mode_t>(info.external_fa >> 16);
  if ((mode & S_IFMT) != 0 && !S_ISREG(mode)) throw Failure{"its entry '" + name + "' is no file" + again};
  return name;
}

void unpack(const std::string& from, const fs::path& folder) {
  const std::unique_ptr<void, int (*)(unzFile)> zip(unzOpen64(from.c_str()), unzClose);
  if (!zip) require_whole(UNZ_BADZIPFILE);
  std::int64_t left = most_bytes;
  int files = 0, code = unzGoToFirstFile(zip.get());
  for (; code == UNZ_OK; code = unzGoToNextFile(zip.get())) {
    if (++files > most_files) throw Failure{"it has more than 10,000 files"};
    if (const std::string name = name_of_entry(zip.get()); !name.empty())
      write(zip.get(), folder / name, left);
  }
  if (code != UNZ_END_OF_LIST_OF_FILE) require_whole(code);
}

/// The parts of modelDescription.xml.
class Description {
 public:
  explicit Description(const std::string& bytes)
      : file_("modelDescription.xml", bytes, "fmiModelDescription") {}

  [[nodiscard]] const XmlPart& root() const { return file_.parts().front(); }
  /// All parts of this type in another one; none where that is null.
  [[nodiscard]] std::vector<const XmlPart*> all(const XmlPart* parent, std::string_view type) const {
    return parent ? file_.all(*parent, type) : std::vector<const XmlPart*>();
  }
  [[nodiscard]] const XmlPart* first(const XmlPart* parent, std::string_view type) const {
    return parent ? file_.first(*parent, type) : nullptr;
  }
  [[nodiscard]] static std::string text(const XmlPart* part, std::string_view attribute) {
    return part ? unescaped(part->tag.attribute(attribute)) : std::string();
  }
  /// `otherwise` where it is missing.
  template <class Number>
  [[nodiscard]] Number number(const XmlPart* part, std::string_view attribute, Number otherwise) const {
    const std::string word = text(part, attribute);
    if (word.empty()) return otherwise;
    Number number{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size())
      fail(*part, std::string(attribute) + "='" + word + "' is no number");
    return number;
  }
  [[noreturn]] void fail(const XmlPart& part, const std::string& what) const {
    file_.fail(part, what + again);
  }

 private:
  XmlFile file_;
};

std::vector<UnitFile::State> states_of(const Description& description) {
  const XmlPart& root = description.root();
  const auto listed = description.all(description.first(&root, "ModelVariables"), "ScalarVariable");
  const XmlPart* const structure = description.first(&root, "ModelStructure");
  // The variable that an attribute names by its place in the list, from 1.
  const auto variable = [&](const XmlPart& part, std::string_view attribute) {
    const auto i = description.number(&part, attribute, 0U);
    if (i < 1 || i > listed.size())
      description.fail(part, "there is no variable '" + description.text(&part, attribute) + "'");
    return listed[i - 1];
  };
  std::vector<UnitFile::State> states;
  for (const XmlPart* each : description.all(description.first(structure, "Derivatives"), "Unknown")) {
    const XmlPart* const rate = description.first(variable(*each, "index"), "Real");
    if (!rate) description.fail(*each, "the derivative is of no variable of type Real");
    const XmlPart* const state = variable(*rate, "derivative");
    const std::string initial = description.text(state, "initial");
    const XmlPart* const real = description.first(state, "Real");
    states.push_back({.name = description.text(state, "name"),
                      .reference = description.number(state, "valueReference", 0U),
                      .has_start = initial == "exact" || initial == "approx" ||
                                   (initial.empty() && real && real->has("start"))});
  }
  if (states.empty())
    throw Failure{
        "it lists no continuous states (ModelStructure, Derivatives); export it with them, or for model exchange"};
  return states;
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

UnitFile open_unit(const std::string& file) {
  std::string name = (fs::temp_directory_path() / "unit_XXXXXX").string();
  if (!mkdtemp(name.data())) throw Failure{"no folder can be made for its files; set TMPDIR"};
  UnitFile unit{.folder = name, .guid = {}, .offers = {}, .states = {}};
  unpack(file, unit.folder);
  const fs::path file_of_description = unit.folder / "modelDescription.xml";
  if (!fs::exists(file_of_description)) throw Failure{std::string("it has no modelDescription.xml") + again};
  const std::string bytes = bytes_of(file_of_description);
  const Description read(bytes);
  const XmlPart& root = read.root();
  if (const std::string version = read.text(&root, "fmiVersion"); !version.starts_with("2."))
    throw Failure{"it is of version '" + version + "' of FMI; export it for 2.0"};
  unit.guid = read.text(&root, "guid");
  for (const auto& [offer, type] :
       {std::pair(&unit.offers[0], "ModelExchange"), {&unit.offers[1], "CoSimulation"}}) {
    const XmlPart* const part = read.first(&root, type);
    const std::string needs_tool = read.text(part, "needsExecutionTool");
    *offer = {.identifier = read.text(part, "modelIdentifier"),
              .needs_tool = needs_tool == "true" || needs_tool == "1"};
  }
  unit.states = states_of(read);
  const XmlPart* const experiment = read.first(&root, "DefaultExperiment");
  unit.start = read.number(experiment, "startTime", 0.0);
  unit.end = read.number(experiment, "stopTime", unit.start + 1);
  unit.step = read.number(experiment, "stepSize", 0.0);
  if (!std::isfinite(unit.start) || !(unit.end > unit.start) || !(unit.step >= 0) ||
      !std::isfinite(unit.step))
    throw Failure{std::string("its DefaultExperiment has an end before its start, or a negative step") +
                  again};
  return unit;
}

}  // namespace hmax::fmi
