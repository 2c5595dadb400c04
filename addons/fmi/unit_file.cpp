#include "addons/fmi/unit_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <minizip/unzip.h>
#include <pugixml.hpp>
#include <string_view>
#include <sys/stat.h>

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
  for (int count = 0; (count = unzReadCurrentFile(zip, block.data(), block.size())) != 0;) {
    require_whole(count);
    if ((left -= count) < 0) throw Failure{"its files have more than 1 GB"};
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

/// A number of an attribute; `otherwise` where it is missing.
template <class Number>
Number number_of(const pugi::xml_attribute& attribute, Number otherwise) {
  if (!attribute) return otherwise;
  const std::string_view text = attribute.value();
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size())
    throw Failure{"modelDescription.xml has " + std::string(attribute.name()) + "='" + std::string(text) +
                  "', which is no number" + again};
  return number;
}

using Variables = std::vector<pugi::xml_node>;

/// The variable that an attribute names by its place in the list, from 1.
pugi::xml_node variable(const Variables& all, const pugi::xml_attribute& place) {
  const auto i = number_of(place, 0U);
  if (i < 1 || i > all.size())
    throw Failure{"modelDescription.xml has no variable '" + std::string(place.value()) +
                  "' under ModelStructure" + again};
  return all[i - 1];
}

std::vector<UnitFile::State> states_of(const pugi::xml_node& root) {
  const auto listed = root.child("ModelVariables").children("ScalarVariable");
  const Variables all(listed.begin(), listed.end());
  std::vector<UnitFile::State> states;
  for (const pugi::xml_node& each : root.child("ModelStructure").child("Derivatives").children("Unknown")) {
    const pugi::xml_node rate = variable(all, each.attribute("index"));
    const pugi::xml_node state = variable(all, rate.child("Real").attribute("derivative"));
    const std::string_view initial = state.attribute("initial").value();
    states.push_back({.name = state.attribute("name").value(),
                      .reference = number_of(state.attribute("valueReference"), 0U),
                      .has_start = initial == "exact" || initial == "approx" ||
                                   (initial.empty() && state.child("Real").attribute("start"))});
  }
  if (states.empty())
    throw Failure{
        "it lists no continuous states (ModelStructure, Derivatives); export it with them, or for model exchange"};
  return states;
}

}  // namespace

UnitFile open_unit(const std::string& file) {
  std::string name = (fs::temp_directory_path() / "unit_XXXXXX").string();
  if (!mkdtemp(name.data())) throw Failure{"no folder can be made for its files; set TMPDIR"};
  UnitFile unit{.folder = name, .guid = {}, .offers = {}, .states = {}};
  unpack(file, unit.folder);
  const fs::path description = unit.folder / "modelDescription.xml";
  if (!fs::exists(description)) throw Failure{std::string("it has no modelDescription.xml") + again};
  pugi::xml_document document;
  if (const pugi::xml_parse_result read = document.load_file(description.c_str()); !read)
    throw Failure{std::string("modelDescription.xml cannot be read: ") + read.description() + again};
  const pugi::xml_node root = document.child("fmiModelDescription");
  if (const std::string version = root.attribute("fmiVersion").value(); !version.starts_with("2."))
    throw Failure{"it is of version '" + version + "' of FMI; export it for 2.0"};
  unit.guid = root.attribute("guid").value();
  for (const auto& [offer, type] :
       {std::pair(&unit.offers[0], "ModelExchange"), {&unit.offers[1], "CoSimulation"}}) {
    const pugi::xml_node node = root.child(type);
    *offer = {.identifier = node.attribute("modelIdentifier").value(),
              .needs_tool = node.attribute("needsExecutionTool").as_bool()};
  }
  unit.states = states_of(root);
  const pugi::xml_node experiment = root.child("DefaultExperiment");
  unit.start = number_of(experiment.attribute("startTime"), 0.0);
  unit.end = number_of(experiment.attribute("stopTime"), unit.start + 1);
  unit.step = number_of(experiment.attribute("stepSize"), 0.0);
  if (!std::isfinite(unit.start) || !(unit.end > unit.start) || !(unit.step >= 0) ||
      !std::isfinite(unit.step))
    throw Failure{std::string("its DefaultExperiment has an end before its start, or a negative step") +
                  again};
  return unit;
}

}  // namespace hmax::fmi
