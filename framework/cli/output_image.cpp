#include "cli/output_image.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <utility>

#include "cli/session.h"

namespace loom::cli {
namespace {

namespace fs = std::filesystem;

}  // namespace

OutputPath::OutputPath(std::string text) {
  const fs::path path(text);
  png_ = path.extension() == ".png";
  if (!png_ && path.extension() != ".exr") {
    throw bad_usage("-o " + text + ": a picture is a .png or an .exr", "for example -o out.png");
  }
  std::error_code ignored;
  const fs::path folder = path.parent_path();
  if (!folder.empty() && !fs::is_directory(folder, ignored)) {
    throw bad_usage("-o " + text + ": the folder " + folder.string() + " does not exist", "make it first");
  }
  if (fs::is_directory(path, ignored)) throw bad_usage("-o " + text + ": is a folder", "name a file");
  const std::size_t percent = text.find('%');
  if (percent == std::string::npos) {
    before_ = std::move(text);
    return;
  }
  const char* first = text.data() + percent + 1;
  const char* end = text.data() + text.size();
  width_ = 0;
  const auto digits = std::from_chars(first, end, width_);
  const bool plain = first != end && *first == 'd';
  const bool padded = first != end && *first == '0' && digits.ec == std::errc{} && digits.ptr != end &&
                      *digits.ptr == 'd' && width_ >= 1 && width_ <= 9;
  const char* letter = plain ? first : digits.ptr;
  if ((!plain && !padded) || std::find(letter, end, '%') != end) {
    throw bad_usage("-o " + text + ": a frame number is written %d or %04d, once", "for example -o out_%04d.png");
  }
  before_ = text.substr(0, percent);
  after_ = std::string(letter + 1, end);
}

std::string OutputPath::of_frame(int frame) const {
  if (!each_frame()) return before_;
  std::string number = std::to_string(frame);
  const auto digits = static_cast<std::size_t>(width_);
  if (number.size() < digits) number.insert(0, digits - number.size(), '0');
  return before_ + number + after_;
}

}  // namespace loom::cli
