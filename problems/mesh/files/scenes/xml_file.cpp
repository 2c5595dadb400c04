#include "problems/mesh/files/scenes/xml_file.hpp"

#include <algorithm>

namespace hmax {

namespace {

std::string without_comments(std::string_view text) {
  std::string kept;
  for (std::size_t at = text.find("<!--"); at != std::string_view::npos; at = text.find("<!--")) {
    kept += text.substr(0, at);
    text.remove_prefix(text.find("-->", at) + 3);  // next_tag() has seen it
  }
  return kept += text;
}

}  // namespace

bool XmlPart::has(std::string_view attribute) const {
  return std::ranges::any_of(tag.attributes, [&](const auto& each) { return each.first == attribute; });
}

XmlFile::XmlFile(const std::string& name, std::string_view bytes, std::string_view root)
    : text_(name, bytes) {
  std::vector<std::size_t> open;  // parts that wait for their ends
  std::int64_t line = 1;
  std::size_t counted = 0, last_end = 0;
  bool follows_begin = false;
  for (auto tag = next_tag(text_, bytes, 0); tag; tag = next_tag(text_, bytes, tag->end)) {
    line += std::count(bytes.begin() + static_cast<std::ptrdiff_t>(counted),
                       bytes.begin() + static_cast<std::ptrdiff_t>(tag->begin), '\n');
    counted = tag->begin;
    if (follows_begin) parts_.back().text = without_comments(bytes.substr(last_end, tag->begin - last_end));
    last_end = tag->end;
    XmlPart part{.type = tag->name, .tag = *tag, .place = line};
    const bool is_end = tag->name.starts_with('/');
    follows_begin = !is_end && !tag->empty;
    if (is_end) {
      if (open.empty() || parts_[open.back()].tag.name != tag->name.substr(1))
        fail(part, "the end " + in_quotes(tag->name) + " has no beginning; correct the file");
      open.pop_back();
      continue;
    }
    if (parts_.empty() ? tag->name != root : open.empty())
      fail(part, "the file is one " + std::string(root) + " with all others in it, and not " +
                     in_quotes(tag->name) + "; correct the file or its extension");
    if (!open.empty()) part.node = open.back();
    if (tag->name == "Object") part.type = tag->attribute("type");
    if (!tag->empty) open.push_back(parts_.size());
    parts_.push_back(std::move(part));
  }
  if (parts_.empty() || !open.empty())
    text_.fail((parts_.empty() ? "the file has no " + std::string(root)
                               : in_quotes(parts_[open.back()].tag.name) + " has no end") +
               "; the file is cut off, so copy or export it again");
}

std::vector<const XmlPart*> XmlFile::within(const XmlPart& part) const {
  std::vector<const XmlPart*> found;
  // What is in a part stands right behind it.
  const auto own = static_cast<std::size_t>(&part - parts_.data());
  for (std::size_t i = own + 1; i < parts_.size() && parts_[i].node >= own; ++i)
    if (parts_[i].node == own) found.push_back(&parts_[i]);
  return found;
}

std::vector<const XmlPart*> XmlFile::all(const XmlPart& part, std::string_view type) const {
  std::vector<const XmlPart*> found = within(part);
  std::erase_if(found, [&](const XmlPart* each) { return each->type != type; });
  return found;
}

const XmlPart* XmlFile::first(const XmlPart& part, std::string_view type) const {
  const std::vector<const XmlPart*> found = all(part, type);
  return found.empty() ? nullptr : found.front();
}

MeshText XmlFile::values(const XmlPart& part, std::string_view text) const {
  MeshText values(name(), text);
  values.about(part.place);
  return values;
}

std::vector<double> XmlFile::numbers(const XmlPart& part, std::string_view attribute) const {
  const std::string what(attribute);
  std::vector<double> numbers;
  for (MeshText rest = values(part, part.tag.attribute(attribute)); !rest.at_end();)
    numbers.push_back(rest.number(what.c_str()));
  return numbers;
}

std::vector<double> XmlFile::numbers(const XmlPart& part, std::string_view attribute,
                                     std::size_t count) const {
  std::vector<double> values = numbers(part, attribute);
  if (values.size() != count)
    fail(part, std::string(part.type) + " has " + std::to_string(values.size()) + " numbers of " +
                   std::string(attribute) + " and should have " + std::to_string(count) + "; correct it");
  return values;
}

std::vector<double> XmlFile::numbers(const XmlPart& part) const {
  std::string text = part.text;
  std::ranges::replace(text, ',', ' ');
  const std::string what = "a number of " + std::string(part.type);
  std::vector<double> numbers;
  for (MeshText rest = values(part, text); !rest.at_end();) numbers.push_back(rest.number(what.c_str()));
  return numbers;
}

}  // namespace hmax
