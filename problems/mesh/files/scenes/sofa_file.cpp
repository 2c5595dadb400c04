#include "problems/mesh/files/scenes/sofa_file.hpp"

#include <algorithm>

namespace hmax {

bool SofaPart::has(std::string_view attribute) const {
  return std::ranges::any_of(tag.attributes, [&](const auto& each) { return each.first == attribute; });
}

SofaFile::SofaFile(const std::string& name, std::string_view bytes) : text_(name, bytes) {
  std::vector<std::string_view> open;   // the names of tags that wait for their ends
  std::vector<std::size_t> open_nodes;  // those of them that are nodes
  std::int64_t line = 1;
  std::size_t counted = 0;
  for (auto tag = next_tag(text_, bytes, 0); tag; tag = next_tag(text_, bytes, tag->end)) {
    line += std::count(bytes.begin() + static_cast<std::ptrdiff_t>(counted),
                       bytes.begin() + static_cast<std::ptrdiff_t>(tag->begin), '\n');
    counted = tag->begin;
    SofaPart part{.type = tag->name, .tag = *tag, .place = line};
    if (tag->name.starts_with('/')) {
      if (open.empty() || open.back() != tag->name.substr(1))
        fail(part, "the end " + in_quotes(tag->name) + " has no beginning; correct the file");
      if (open.back() == "Node") open_nodes.pop_back();
      open.pop_back();
      continue;
    }
    if (parts_.empty() != (tag->name == "Node" && open.empty()))
      fail(part, "a scene of SOFA is one Node with all others in it, and not " + in_quotes(tag->name) +
                     "; correct the file or its extension");
    if (!open_nodes.empty()) part.node = open_nodes.back();
    if (tag->name == "Object") part.type = tag->attribute("type");
    if (!tag->empty) open.push_back(tag->name);
    if (!tag->empty && tag->name == "Node") open_nodes.push_back(parts_.size());
    parts_.push_back(std::move(part));
  }
  if (parts_.empty() || !open.empty())
    text_.fail(
        (parts_.empty() ? std::string("the file has no Node") : in_quotes(open.back()) + " has no end") +
        "; the file is cut off, so copy or export it again");
}

const SofaPart& SofaFile::state() const {
  const auto found = std::ranges::find(parts_, "MechanicalObject", &SofaPart::type);
  if (found == parts_.end()) text_.fail("the scene has no MechanicalObject and so no body; add one");
  return *found;
}

MeshText SofaFile::at(const SofaPart& part) const {
  MeshText there = text_;
  there.about(part.place);
  return there;
}

std::vector<double> SofaFile::numbers(const SofaPart& part, std::string_view attribute) const {
  MeshText values(name(), part.tag.attribute(attribute));
  values.about(part.place);
  const std::string what(attribute);
  std::vector<double> numbers;
  while (!values.at_end()) numbers.push_back(values.number(what.c_str()));
  return numbers;
}

std::vector<double> SofaFile::numbers(const SofaPart& part, std::string_view attribute,
                                      std::size_t count) const {
  std::vector<double> values = numbers(part, attribute);
  if (values.size() != count)
    fail(part, std::string(part.type) + " has " + std::to_string(values.size()) + " numbers of " +
                   std::string(attribute) + " and should have " + std::to_string(count) + "; correct it");
  return values;
}

const SofaPart& SofaFile::linked(const SofaPart& part, std::string_view attribute) const {
  std::string_view name = part.tag.attribute(attribute);
  name.remove_prefix(std::min(name.find_last_of("@/") + 1, name.size()));
  name = name.substr(0, name.find('.'));
  const auto found = std::ranges::find(parts_, name, &SofaPart::name);
  if (name.empty() || found == parts_.end())
    fail(part, std::string(attribute) + " of " + std::string(part.type) + " is " +
                   in_quotes(part.tag.attribute(attribute)) + ", and no component has this name; correct it");
  return *found;
}

}  // namespace hmax
