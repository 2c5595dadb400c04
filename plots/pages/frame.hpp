/// What every page of HTML has around its content: title, navigation, theme, sorted tables, print.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hmax {

/// An entry of the navigation of a page.
struct PageLink {
  std::string target;  ///< "#id"
  std::string text;    ///< shown as it is
};

/// A page without its common parts. Texts named HTML are put into the page unchanged.
struct PageFrame {
  std::string title;                 ///< shown as it is
  std::string introduction = {};     ///< HTML below the title
  std::vector<PageLink> links = {};  ///< a navigation is shown for two or more
  std::string main = {};             ///< HTML
  std::string footer = {};           ///< HTML; empty for none
  std::string style = {};            ///< rules after those of page.css
  std::string data = {};             ///< HTML behind the content, before the script
  std::string script = {};           ///< runs after theme.js and sort_tables.js
};

/// The page: one file that needs no network and no other file. It has a light and a dark theme, fits phones
/// and paper, and its tables sort where they are plain tables with a `thead`.
std::string framed_page(const PageFrame& frame);

/// A style or a script of page_texts.hpp.
/// @param name  of a file that exists, without its ending
std::string_view page_style(std::string_view name);
std::string_view page_script(std::string_view name);

}  // namespace hmax
