#include "plots/pages/report_bodies.hpp"

#include <cstddef>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include "core/errors.hpp"
#include "plots/pages/body_scene.hpp"
#include "plots/svg.hpp"

namespace hmax {

std::string report_bodies(std::span<const ReportedStore> stores) {
  constexpr std::size_t most_bytes = 3'500'000;  // leaves room for rows on a page of 5 MB
  std::set<std::string_view> shown;
  std::size_t without_room = 0;
  std::string html;
  for (const ReportedStore& store : stores)
    for (const AdviceScene& each : store.scenes) {
      if (!shown.insert(each.scene).second) continue;
      std::string body;
      try {
        body = scene_html(each.scene, fmt::format("body-{}", shown.size()));
      } catch (const InputError& error) {
        body =
            fmt::format("<p>{}: not shown. {}</p>\n", html_text(each.key.problem), html_text(error.what()));
      }
      if (html.size() + body.size() <= most_bytes)
        html += body;
      else
        ++without_room;
    }
  if (without_room > 0)
    html += fmt::format("<p>{} more {} not shown, to keep the page small; name fewer stores.</p>\n",
                        without_room, without_room == 1 ? "body is" : "bodies are");
  return html;
}

}  // namespace hmax
