#include "plots/pages/markdown_page.hpp"

#include <algorithm>
#include <cctype>
#include <cmark-gfm-core-extensions.h>
#include <cmark-gfm.h>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "plots/pages/embedded.hpp"
#include "plots/pages/frame.hpp"
#include "plots/svg.hpp"

namespace hmax {

namespace {

namespace fs = std::filesystem;

using Parser = std::unique_ptr<cmark_parser, decltype(&cmark_parser_free)>;
using Node = std::unique_ptr<cmark_node, decltype(&cmark_node_free)>;

/// A parsed text. CMARK_OPT_UNSAFE is never given: no markup and no script of the text comes into the HTML.
class Document {
 public:
  explicit Document(const std::string& markdown)
      : parser_(cmark_parser_new(CMARK_OPT_VALIDATE_UTF8), &cmark_parser_free),
        root_(nullptr, &cmark_node_free) {
    cmark_gfm_core_extensions_ensure_registered();
    cmark_parser_attach_syntax_extension(parser_.get(), cmark_find_syntax_extension("table"));
    cmark_parser_feed(parser_.get(), markdown.data(), markdown.size());
    root_.reset(cmark_parser_finish(parser_.get()));
    cmark_consolidate_text_nodes(root_.get());
  }

  cmark_node* root() { return root_.get(); }

  /// Every node of a type, in the order of the text.
  std::vector<cmark_node*> all(const std::string& type) {
    std::vector<cmark_node*> found;
    const std::unique_ptr<cmark_iter, decltype(&cmark_iter_free)> each(cmark_iter_new(root()),
                                                                       &cmark_iter_free);
    for (cmark_event_type event; (event = cmark_iter_next(each.get())) != CMARK_EVENT_DONE;)
      if (cmark_node* node = cmark_iter_get_node(each.get());
          event == CMARK_EVENT_ENTER && cmark_node_get_type_string(node) == type)
        found.push_back(node);
    return found;
  }

  std::string html(cmark_node* node) {
    const std::unique_ptr<char, decltype(&std::free)> text(
        cmark_render_html(node, CMARK_OPT_DEFAULT, cmark_parser_get_syntax_extensions(parser_.get())),
        &std::free);
    return text.get();
  }

 private:
  Parser parser_;
  Node root_;
};

/// What a node says, without its markup.
std::string words_of(cmark_node* node) {
  if (const char* literal = cmark_node_get_literal(node)) return literal;
  if (cmark_node_get_type(node) == CMARK_NODE_SOFTBREAK || cmark_node_get_type(node) == CMARK_NODE_LINEBREAK)
    return " ";
  std::string words;
  for (cmark_node* child = cmark_node_first_child(node); child; child = cmark_node_next(child))
    words += words_of(child);
  return words;
}

/// A node that stands for HTML.
cmark_node* html_node(cmark_node_type type, const std::string& html) {
  cmark_node* made = cmark_node_new(type);
  cmark_node_set_on_enter(made, html.c_str());
  return made;
}

void replace(cmark_node* old, cmark_node* by) {
  cmark_node_replace(old, by);
  cmark_node_free(old);
}

void remove(cmark_node* node) {
  cmark_node_unlink(node);
  cmark_node_free(node);
}

/// Comments are left out.
void show_markup_as_text(Document& document) {
  for (const auto& [type, block] : {std::pair{"html_block", true}, {"html_inline", false}})
    for (cmark_node* markup : document.all(type)) {
      const std::string literal = cmark_node_get_literal(markup);
      if (literal.starts_with("<!--")) {
        remove(markup);
        continue;
      }
      cmark_node* text = cmark_node_new(CMARK_NODE_TEXT);
      cmark_node_set_literal(text, literal.c_str());
      cmark_node* shown = block ? cmark_node_new(CMARK_NODE_PARAGRAPH) : text;
      if (block) cmark_node_append_child(shown, text);
      replace(markup, shown);
    }
}

bool is_alone(cmark_node* node) { return !cmark_node_previous(node) && !cmark_node_next(node); }

/// Of a path below the folder of the page; empty for another host, an absolute path and a file that cannot be
/// read.
std::string bytes_of(const fs::path& folder, const fs::path& file) {
  if (file.empty() || file.is_absolute() || file.string().find(':') != std::string::npos) return {};
  if (std::ranges::find(file, fs::path("..")) != file.end()) return {};
  std::ifstream stream(folder / file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A picture of the page, as `img` in the forms that its files allow; the best comes first.
struct Picture {
  cmark_node* place;  ///< shows it
  bool figure;        ///< in a paragraph of its own
  std::string file, link{}, alt;
  enum class Kind { svg, png };
  std::vector<std::pair<Kind, std::string>> forms = {};
  std::size_t form = 0;  ///< number of forms: a link only

  [[nodiscard]] bool is_linked() const { return form == forms.size(); }
  [[nodiscard]] bool is(Kind kind) const { return !is_linked() && forms[form].first == kind; }
  [[nodiscard]] std::size_t size() const { return is_linked() ? 0 : forms[form].second.size(); }
};

void add_forms(Picture& picture, const fs::path& folder) {
  const auto bytes = [&](const char* ending) {
    return bytes_of(folder, fs::path(picture.file).replace_extension(ending));
  };
  const std::string svg = bytes(".svg"), png = bytes(".png");
  if (!svg.empty()) picture.forms.emplace_back(Picture::Kind::svg, embedded_svg(svg, picture.alt));
  if (!png.empty()) picture.forms.emplace_back(Picture::Kind::png, embedded_png(png, picture.alt));
}

/// Whether a node stands in another of this type.
bool is_below(cmark_node* node, std::string_view type) {
  for (cmark_node* above = cmark_node_parent(node); above; above = cmark_node_parent(above))
    if (cmark_node_get_type_string(above) == type) return true;
  return false;
}

/// The pictures of a document, each in an empty node now.
std::vector<Picture> take_pictures(Document& document, const fs::path& folder) {
  std::vector<Picture> pictures;
  for (cmark_node* image : document.all("image")) {
    // Nodes in headings are copied, and those in other pictures gone with them.
    if (is_below(image, "image") || is_below(image, "heading")) continue;
    Picture picture{
        .place = nullptr, .figure = false, .file = cmark_node_get_url(image), .alt = words_of(image)};
    picture.link = picture.file;
    cmark_node* outer = image;
    if (cmark_node* parent = cmark_node_parent(outer);
        cmark_node_get_type(parent) == CMARK_NODE_LINK && is_alone(outer)) {
      const std::string url = cmark_node_get_url(parent);
      if (url.find(':') == std::string::npos) picture.link = url;  // no script
      outer = parent;
    }
    if (cmark_node* parent = cmark_node_parent(outer);
        cmark_node_get_type(parent) == CMARK_NODE_PARAGRAPH && is_alone(outer)) {
      picture.figure = true;
      outer = parent;
    }
    add_forms(picture, folder);
    picture.place = html_node(picture.figure ? CMARK_NODE_CUSTOM_BLOCK : CMARK_NODE_CUSTOM_INLINE, "");
    replace(outer, picture.place);
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

std::string counted(std::size_t count, const char* words) {
  return fmt::format("{} {}{}", count, count == 1 ? "figure" : "figures", words);
}

/// Takes smaller forms of the largest pictures until all fit.
/// @return  what the page says of it, as HTML
std::string fit(std::vector<Picture>& pictures, std::size_t room) {
  const auto total = [&] {
    std::size_t sum = 0;
    for (const Picture& picture : pictures) sum += picture.size();
    return sum;
  };
  while (total() > room) {
    Picture& largest = *std::ranges::max_element(pictures, {}, &Picture::size);
    const std::size_t before = largest.size();
    do ++largest.form;
    while (largest.size() >= before);
  }
  const auto count = [&](const auto& is_one) {
    return static_cast<std::size_t>(std::ranges::count_if(pictures, is_one));
  };
  const auto was_larger = [](const Picture& picture) { return picture.form > 0; };
  const std::size_t png = count([&](const Picture& p) { return was_larger(p) && p.is(Picture::Kind::png); });
  const std::size_t linked = count([&](const Picture& p) { return was_larger(p) && p.is_linked(); });
  std::string words = png > 0 ? counted(png, " as PNG") : "";
  if (linked > 0) words += (words.empty() ? "" : " and ") + counted(linked, " as a link");
  if (words.empty()) return {};
  return fmt::format("<p>The page shows {}, because it would be larger than 5 MB.</p>\n", words);
}

void show(const Picture& picture) {
  std::string html = picture.is_linked() ? html_text(picture.alt) : picture.forms[picture.form].second;
  html = fmt::format("<a href=\"{}\">{}</a>", html_text(picture.link), html);
  if (picture.figure) html = fmt::format("<figure>{}</figure>\n", html);
  cmark_node_set_on_enter(picture.place, html.c_str());
}

void lead_to_pages(Document& document, const fs::path& folder) {
  constexpr std::string_view readme = "README.md";
  for (cmark_node* link : document.all("link")) {
    const std::string url = cmark_node_get_url(link), path = url.substr(0, url.find('#'));
    // Not to the page itself: its own README.md is the same text.
    if (!path.ends_with("/README.md") || path.find(':') != std::string::npos) continue;
    const std::string page = path.substr(0, path.size() - readme.size()) + "index.html";
    if (fs::exists(folder / page)) cmark_node_set_url(link, (page + url.substr(path.size())).c_str());
  }
}

/// The title, the navigation and the ids; the text is left.
MarkdownParts take_headings(Document& document) {
  MarkdownParts found;
  std::map<std::string, int> times;
  for (cmark_node* heading : document.all("heading")) {
    const std::string words = words_of(heading);
    const int level = cmark_node_get_heading_level(heading);
    if (level == 1 && found.title.empty()) {
      found.title = words;
      remove(heading);
      continue;
    }
    std::string id = heading_anchor(words);
    if (const int before = times[id]++) id += fmt::format("-{}", before);
    if (level == 2) found.links.push_back({"#" + id, words});
    const std::string opening = fmt::format("<h{}", level);
    const std::string html = document.html(heading).substr(opening.size());
    replace(heading,
            html_node(CMARK_NODE_CUSTOM_BLOCK, fmt::format("{} id=\"{}\"{}", opening, html_text(id), html)));
  }
  return found;
}

/// Wide tables scroll, also with the keyboard; the label is for screen readers.
void put_tables_in_boxes(Document& document) {
  std::string section;
  for (cmark_node* node = cmark_node_first_child(document.root()); node; node = cmark_node_next(node)) {
    const std::string type = cmark_node_get_type_string(node);
    if (type == "heading") section = words_of(node);
    if (type != "table") continue;
    std::string box = fmt::format(
        "<div class=\"scroll prose\" tabindex=\"0\" role=\"region\" aria-label=\"{}\">", html_text(section));
    // As markdown_facts() writes them.
    if (cmark_node* headings = cmark_node_first_child(node); words_of(headings).empty()) {
      remove(headings);
      box = "<div class=\"facts\">";
    }
    cmark_node_insert_before(node, html_node(CMARK_NODE_CUSTOM_BLOCK, box));
    cmark_node* closing = html_node(CMARK_NODE_CUSTOM_BLOCK, "</div>");
    cmark_node_insert_after(node, closing);
    node = closing;
  }
}

}  // namespace

std::string heading_anchor(std::string_view heading) {
  std::string anchor;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == ' ')
      anchor += '-';
    else if (std::isalnum(byte) || c == '-' || c == '_' || byte > 127)
      anchor += static_cast<char>(byte > 127 ? byte : std::tolower(byte));
  }
  return anchor;
}

MarkdownParts markdown_parts(const std::string& markdown) {
  Document document(markdown);
  show_markup_as_text(document);
  put_tables_in_boxes(document);
  MarkdownParts parts = take_headings(document);
  parts.html = document.html(document.root());
  return parts;
}

std::string markdown_page(const std::string& markdown, const fs::path& folder, std::size_t most_bytes) {
  Document document(markdown);
  show_markup_as_text(document);
  lead_to_pages(document, folder);
  std::vector<Picture> pictures = take_pictures(document, folder);
  put_tables_in_boxes(document);
  MarkdownParts parts = take_headings(document);
  PageFrame frame{.title = std::move(parts.title),
                  .links = std::move(parts.links),
                  .main = document.html(document.root()),
                  .footer = "<p>The same text in Markdown: <a href=\"README.md\">README.md</a></p>"};
  // Of the frame, of the tags around pictures, and of what is said of them.
  std::size_t other = framed_page(frame).size() + 1000;
  for (const Picture& picture : pictures) other += 100 + picture.alt.size() * 2 + picture.link.size() * 2;
  frame.introduction = fit(pictures, most_bytes > other ? most_bytes - other : 0);
  for (const Picture& picture : pictures) show(picture);
  frame.main = document.html(document.root());
  // What stands before the first section belongs above the navigation.
  const std::size_t sections = std::min(frame.main.find("<h2 "), frame.main.size());
  frame.introduction.insert(0, frame.main, 0, sections);
  frame.main.erase(0, sections);
  return framed_page(frame);
}

}  // namespace hmax
