#include "measure/layers.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <set>
#include <utility>

#include "loom/diagnostic.h"

namespace loom::measure {
namespace {

constexpr std::string_view rgb = "RGB";

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::string attribute(const ImageLayers& image, const std::string& key) {
  const auto found = image.attributes.find(key);
  return found == image.attributes.end() ? std::string{} : found->second;
}

/// "indirect.G" -> "indirect"; "R" -> "".
std::string prefix_of(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == std::string::npos ? std::string{} : channel.substr(0, dot);
}

bool is_bare_rgb(std::string_view name) { return name.empty() || lower(name) == "rgb"; }

bool has_layer(const ImageLayers& image, const std::string& name) {
  const std::vector<std::string> names = layer_names(image);
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

/// The channels of `prefix` ("" or "indirect."): R G B or X Y Z in that order, else all of them, sorted.
std::vector<std::string> channels_of(const ImageLayers& image, const std::string& prefix) {
  for (const std::array<const char*, 3>& order : {std::array{"R", "G", "B"}, std::array{"X", "Y", "Z"}}) {
    std::vector<std::string> names;
    for (const char* component : order) {
      if (image.channels.contains(prefix + component)) names.push_back(prefix + component);
    }
    if (names.size() == order.size()) return names;
  }
  std::vector<std::string> names;
  for (const auto& [channel, values] : image.channels) {
    const bool member = prefix.empty() ? channel == "Y" : channel.starts_with(prefix);
    if (member) names.push_back(channel);
  }
  return names;
}

[[noreturn]] void missing_layer(const ImageFile& file, std::string_view name) {
  const std::vector<std::string> names = layer_names(file.image);
  const std::string near = nearest_name(name, names);
  throw BadInput(Diagnostic{.code = "missing-layer",
                            .message = "there is no layer `" + std::string(name) + "`, but " + joined(names),
                            .where = {.file = file.path},
                            .hint = near.empty() ? "choose one with --layer A:REF" : "did you mean `" + near + "`?"});
}

[[noreturn]] void mismatch(const ImageFile& a, const ImageFile& reference, const std::string& why) {
  throw BadInput(Diagnostic{.code = "quantity-mismatch",
                            .message = a.path + " holds " + a.quantity() + ", and " + reference.path + " " + why,
                            .where = {.file = a.path},
                            .hint = "compare like with like, or insist with --layer A:REF (" + reference.path +
                                    " has " + joined(layer_names(reference.image)) + ")"});
}

/// `direct` of "direct.irradiance.irradiance", `bounce` of "bounce".
std::string output_layer(const ImageLayers& image) {
  const std::string output = attribute(image, "loom:output");
  return output.substr(0, output.find('.'));
}

/// The layer of the reference that A's quantity asks for.
std::string reference_layer(const ImageFile& a, const ImageFile& reference) {
  const std::string quantity = a.quantity();
  const std::string theirs = reference.quantity();
  const bool same = theirs.empty() || theirs == quantity;
  if (quantity.empty()) {
    // An output that carries nothing ("indirect": null, all black) has no quantity, but it is still that output.
    const std::string output = output_layer(a.image);
    return !output.empty() && has_layer(reference.image, output) ? output : std::string(rgb);
  }
  if (quantity == "radiance") {
    if (!same) mismatch(a, reference, "holds " + theirs);
    return std::string(rgb);
  }
  std::string layer = quantity;
  if (quantity == "irradiance") {
    layer = output_layer(a.image);
    if (layer.empty()) layer = "indirect";
  }
  if (has_layer(reference.image, layer)) return layer;
  if (!same) mismatch(a, reference, "holds " + theirs + " and has no layer `" + layer + "`");
  const std::string ours_output = output_layer(a.image);
  const std::string their_output = output_layer(reference.image);
  if (!ours_output.empty() && !their_output.empty() && ours_output != their_output) {
    mismatch(a, reference, "holds it of another output (" + their_output + ", not " + ours_output + ")");
  }
  return std::string(rgb);
}

}  // namespace

bool Layer::is_color() const {
  return planes.size() == 3 && channels[0].ends_with('R') && channels[1].ends_with('G') && channels[2].ends_with('B') &&
         name != "normal";
}

std::string ImageFile::quantity() const { return hdr ? attribute(image, "loom:quantity") : "display"; }

ImageFile read_image(const std::string& path) {
  const std::string ending = lower(std::filesystem::path(path).extension().string());
  if (ending == ".exr") return {.path = path, .image = read_exr(path), .hdr = true};
  if (ending == ".png") return {.path = path, .image = read_png(path), .hdr = false};
  throw BadInput(Diagnostic{.code = "unknown-image",
                            .message = "neither .exr nor .png",
                            .where = {.file = path},
                            .hint = "compare reads EXR (scene-referred) and PNG (display-referred)"});
}

std::vector<std::string> layer_names(const ImageLayers& image) {
  const bool bare_layer = !channels_of(image, "").empty();
  std::set<std::string> prefixes;
  for (const auto& [channel, values] : image.channels) {
    const std::string prefix = prefix_of(channel);
    if (!prefix.empty()) {
      prefixes.insert(prefix);
    } else if (!bare_layer) {
      prefixes.insert(channel);
    }
  }
  std::vector<std::string> names;
  if (bare_layer) names.emplace_back(rgb);
  names.insert(names.end(), prefixes.begin(), prefixes.end());
  return names;
}

Layer find_layer(const ImageFile& file, std::string_view name) {
  const ImageLayers& image = file.image;
  const bool bare = is_bare_rgb(name);
  std::vector<std::string> channels = channels_of(image, bare ? std::string{} : std::string(name) + ".");
  if (channels.empty() && !bare && image.channels.contains(std::string(name))) channels.emplace_back(name);
  if (channels.empty()) missing_layer(file, bare ? rgb : name);
  Layer layer{.width = image.width,
              .height = image.height,
              .name = bare ? std::string(rgb) : std::string(name),
              .channels = std::move(channels),
              .planes = {}};
  for (const std::string& channel : layer.channels) layer.planes.emplace_back(image.channels.at(channel));
  return layer;
}

LayerPair match_layers(const ImageFile& a, const ImageFile& reference, const std::optional<std::string>& choice) {
  if (a.image.width != reference.image.width || a.image.height != reference.image.height) {
    const auto size = [](const ImageLayers& image) {
      return std::to_string(image.width) + "x" + std::to_string(image.height);
    };
    throw BadInput(Diagnostic{.code = "size-mismatch",
                              .message = "sizes differ: " + a.path + " is " + size(a.image) + ", " + reference.path +
                                         " is " + size(reference.image),
                              .hint = "render at --size " + size(reference.image)});
  }
  std::string name_a(rgb), name_reference;
  if (choice) {
    const std::size_t colon = choice->find(':');
    name_a = choice->substr(0, colon);
    name_reference = colon == std::string::npos ? name_a : choice->substr(colon + 1);
  } else {
    name_reference = reference_layer(a, reference);
  }
  LayerPair pair{.a = find_layer(a, name_a), .reference = find_layer(reference, name_reference)};
  // A render writes any output as R G B; of a one-channel quantity (depth) the first is the quantity.
  if (pair.reference.planes.size() == 1 && pair.a.planes.size() == 3 && !choice) {
    pair.a.channels.resize(1);
    pair.a.planes.resize(1);
  }
  if (pair.a.planes.size() != pair.reference.planes.size()) {
    throw BadInput(Diagnostic{.code = "channel-mismatch",
                              .message = "channels differ: " + a.path + " gives " + joined(pair.a.channels) + ", " +
                                         reference.path + " gives " + joined(pair.reference.channels),
                              .hint = "name a single channel on both sides, for example --layer R:depth.Z"});
  }
  return pair;
}

}  // namespace loom::measure
