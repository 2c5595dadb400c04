#include "addons/fmi/unit_file.hpp"

#include <algorithm>
#include <archive.h>
#include <archive_entry.h>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <pugixml.hpp>
#include <string_view>

namespace hmax::fmi {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t most_bytes = 1'000'000'000;
constexpr int most_files = 10'000;
constexpr const char* again = "; export it again";

[[noreturn]] void refuse_damaged(archive* zip) {
  const char* why = archive_error_string(zip);
  throw Failure{std::string("the archive (zip) cannot be read: ") + (why ? why : "it is damaged") + again};
}

void write(archive* zip, const fs::path& file, std::int64_t& left) {
  fs::create_directories(file.parent_path());
  std::ofstream out(file, std::ios::binary);
  std::array<char, 65536> block;
  while (true) {
    const la_ssize_t count = archive_read_data(zip, block.data(), block.size());
    if (count < 0) refuse_damaged(zip);
    if (count == 0) break;
    if ((left -= count) < 0) throw Failure{"its files have more than 1 GB"};
    out.write(block.data(), count);
  }
  if (!out.flush())
    throw Failure{"'" + file.string() + "' cannot be written; set TMPDIR to a place with room"};
}

void unpack(const std::string& from, const fs::path& folder) {
  const std::unique_ptr<archive, int (*)(archive*)> zip(archive_read_new(), archive_read_free);
  archive_read_support_format_zip(zip.get());
  if (archive_read_open_filename(zip.get(), from.c_str(), 65536) != ARCHIVE_OK) refuse_damaged(zip.get());
  std::int64_t left = most_bytes;
  archive_entry* entry = nullptr;
  for (int files = 0;;) {
    const int code = archive_read_next_header(zip.get(), &entry);
    if (code == ARCHIVE_EOF) return;
    if (code < ARCHIVE_WARN) refuse_damaged(zip.get());
    const char* const text = archive_entry_pathname_utf8(entry);
    const std::string name = text ? text : "";
    const fs::path path = name;
    if (path.is_absolute() || std::ranges::find(path, "..") != path.end())
      throw Failure{"its entry '" + name + "' would lie outside of it" + again};
    const bool needed = name == "modelDescription.xml" || name.starts_with("binaries/linux64/") ||
                        name.starts_with("resources/");
    if (!needed || archive_entry_filetype(entry) == AE_IFDIR) continue;
    if (archive_entry_filetype(entry) != AE_IFREG)
      throw Failure{"its entry '" + name + "' is no file" + again};
    if (++files > most_files) throw Failure{"it has more than 10,000 files"};
    write(zip.get(), folder / path, left);
  }
}

using Variables = std::vector<pugi::xml_node>;

/// The variable that an attribute names by its place in the list, from 1.
pugi::xml_node variable(const Variables& all, const pugi::xml_attribute& place) {
  const unsigned int i = place.as_uint();
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
                      .reference = state.attribute("valueReference").as_uint(),
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
  unit.start = experiment.attribute("startTime").as_double();
  unit.end = experiment.attribute("stopTime").as_double(unit.start + 1);
  unit.step = experiment.attribute("stepSize").as_double();
  if (!std::isfinite(unit.start) || !(unit.end > unit.start) || !(unit.step >= 0) ||
      !std::isfinite(unit.step))
    throw Failure{std::string("its DefaultExperiment has an end before its start, or a negative step") +
                  again};
  return unit;
}

}  // namespace hmax::fmi
