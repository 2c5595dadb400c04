/// The section of `hmax reproduce tissue` on the image of an echograph, and `hmax reproduce slice`.
#include <numbers>

#include <fmt/format.h>

#include "cli/reproduce/parts.hpp"
#include "cli/reproduce/tissue_page.hpp"
#include "cli/shared/mpirun.hpp"
#include "cli/shared/options.hpp"
#include "cli/shared/outputs.hpp"
#include "core/errors.hpp"
#include "plots/drawn/images.hpp"
#include "results/json.hpp"
#include "results/table.hpp"
#include "studies/thigh/echography.hpp"

namespace hmax {

namespace {

Json gap_row(const char* of, const GapError& error) {
  return {{"of", of}, HMAX_KEYS(error, at_points, halfway, all)};
}

void draw_slices(TissuePage& tissue, const Echography& study) {
  ImagePicture picture{
      .title = "Slices of a synthetic thigh, at rest and pressed by a probe",
      .caption =
          fmt::format("Synthetic: voxels with speckle, no acoustics. The probe presses the middle of the "
                      "skin by {:g} mm. Lines: vein and bone as finite elements with regions have them.",
                      1000 * study.press.depth),
      .pixel = study.pixel};
  for (const EchoImage& image : study.images) {
    PixelImage& shown = picture.images.emplace_back(PixelImage{image.title, image.grey});
    if (!image.vein.empty()) shown.lines.push_back({"wall of the vein", 4, image.vein});
    if (!image.bone.empty()) shown.lines.push_back({"surface of the bone", 5, image.bone});
    write_file(tissue.page.folder / fmt::format("slice_{}.png", image.name), png_of(image.grey, 256));
  }
  const std::filesystem::path base = tissue.page.folder / "echography", file = base.string() + ".svg";
  write_file(file, images_svg(picture));
  tissue.page.show(FigureFiles{base, {file}, {}, picture.title});
}

struct SliceOptions {
  std::string at = "84,60", rule = "rest", output = "slice.png";
  std::optional<double> angle, tilt, press;
  bool images = false;
};

void write_slice(const SliceOptions& options, Console& console) {
  refuse_copies("hmax reproduce slice");
  const std::vector<double> at = parse_numbers("--at", options.at);
  if (at.size() != 2)
    throw InputError(
        fmt::format("--at {} is no point of the skin; write two numbers, like 84,60", options.at));
  if (options.press && options.rule == "rest")
    throw InputError("--press is for a slice that is deformed; add --rule elements, or leave it out");
  if (!options.output.ends_with(".png"))
    throw InputError(fmt::format("the slice {} would be a PNG; let its name end in .png", options.output));
  check_writable(options.output);
  constexpr double degree = std::numbers::pi / 180;
  SliceChoice choice{.x = at[0] / 1000,
                     .y = at[1] / 1000,
                     .angle = options.angle.value_or(0) * degree,
                     .tilt = options.tilt.value_or(0) * degree,
                     .of_images = options.images,
                     .rule = options.rule};
  if (options.press) choice.depth = *options.press / 1000;
  const std::vector<std::uint8_t> grey = chosen_slice(choice);
  write_file(options.output, png_of(grey, 256));
  console.show({{"slice", options.output}, {"pixels", 256}}, fmt::format("Open {}\n", options.output));
}

}  // namespace

void echographic_image(TissuePage& tissue, const std::function<void(const std::string&)>& progress) {
  const Echography study = echography(progress);
  Json& told = tissue.document["echography"];
  told = {
      {"pixel", study.pixel},
      {"gaps",
       {gap_row("voxels with speckle", study.gaps), gap_row("tissues without speckle", study.tissue_gaps)}},
      HMAX_KEYS(study, rules, steps, largest_step, slice_seconds, step_seconds)};
  Json values = told;
  for (std::size_t i = 0; i < study.steps.size(); ++i)
    values["steps"][i]["within"] = study.steps[i].within(study.pixel);
  values["megabytes"] = study.bytes / 1e6;
  values["images"] = true_thigh().points();
  values["distance"] = study.image_distance;
  values["vein"] = 2 * ThighAnatomy::vein_radius;
  values["depth"] = study.press.depth;
  values["rise"] = study.press.rise;
  values["frame"] = study.frame;
  values["fast"] = study.slice_seconds + study.step_seconds < study.frame;
  values["any_step"] = study.largest_step > 0;
  values["one_a_frame"] = study.largest_step == study.frame;
  tissue.page.values["echo"] = values;
  draw_slices(tissue, study);
}

void add_slice(CLI::App& reproduce, Console& console) {
  const auto [slice, options] = add_command(
      reproduce, console, "slice", "Write a slice of the synthetic thigh of the tissue report as PNG",
      {"hmax reproduce slice --at 84,60 --angle 30 --output slice.png",
       "hmax reproduce slice --rule elements --press 16 --output pressed.png"},
      write_slice);
  show_default(add_text(slice, "--at", options.at,
                        "Middle of its upper edge on the skin, around and along the bone [mm]", "X,Y"));
  add_number(slice, "--angle", options.angle,
             "Angle from the bone, about the normal of the skin [degree]; 0 by default");
  add_number(slice, "--tilt", options.tilt, "Angle out of this normal [degree]; 0 by default");
  add_flag(slice, "--images", options.images,
           "Of the 64 images of the probe, with gaps filled, instead of the voxels");
  show_default(add_text(
      slice, "--rule", options.rule,
      "How the probe deforms it: rest, linear (to the foot of the image), bone (linear to the bone), elements"));
  add_number(slice, "--press", options.press,
             "Depth of the probe with another rule than rest [mm]; 16 by default");
  show_default(
      add_text(slice, "--output", options.output, "File of 256 x 256 pixels, 80 mm wide", "FILE.png"));
  add_force(slice);
}

}  // namespace hmax
