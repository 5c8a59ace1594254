// loom new-pass: the folder of a pass that builds out of tree and runs by --plugins.
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include "cli/commands.h"
#include "cli/new_pass_files.h"
#include "core/image_io.h"

namespace loom::cli {
namespace {

namespace fs = std::filesystem;

bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }
bool is_alnum(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }
char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }
char upper(char c) { return static_cast<char>(std::toupper(static_cast<unsigned char>(c))); }

/// GatherRSM, gather_rsm and gather-rsm are one name.
PassNames names_of(const std::string& text) {
  PassNames names;
  bool word_begins = true;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '_' || c == '-') {
      word_begins = true;
      continue;
    }
    // A capital begins a word after a small letter, or as the last of several capitals before one: RSM, GatherRSM,
    // RSMGather.
    const bool after_small = i > 0 && is_alnum(text[i - 1]) && !is_upper(text[i - 1]);
    const bool before_small = i + 1 < text.size() && is_alnum(text[i + 1]) && !is_upper(text[i + 1]);
    const bool after_capital = i > 0 && is_upper(text[i - 1]);
    const bool begins = word_begins || (is_upper(c) && (after_small || (after_capital && before_small)));
    if (begins && !names.snake.empty()) names.snake += '_';
    names.snake += lower(c);
    names.type += word_begins ? upper(c) : c;
    word_begins = false;
  }
  return names;
}

void check_name(const std::string& name) {
  bool good = !name.empty() && std::isalpha(static_cast<unsigned char>(name.front())) != 0 && name.size() <= 64;
  for (const char c : name) good = good && (is_alnum(c) || c == '_' || c == '-');
  if (!good) {
    throw bad_usage("new-pass " + name + ": a pass is named by letters and digits, a letter first",
                    "for example loom new-pass ScreenSpaceGather");
  }
}

void write_folder(const fs::path& folder, const PassNames& names) {
  for (const auto& [path, text] : new_pass_files(names)) {
    fs::create_directories((folder / path).parent_path());
    write_file_atomic((folder / path).string(), std::as_bytes(std::span(text)));
  }
}

void run(const std::string& name, const Session& session) {
  check_name(name);
  const PassNames names = names_of(name);
  const Registry registry = load_registry(session);
  if (const PassType* taken = registry.pass(names.type); taken != nullptr) {
    throw bad_input("duplicate-type", "there is a pass " + names.type + " already, in " + taken->plugin,
                    "choose another name");
  }
  const fs::path folder = names.snake;
  std::error_code error;
  if (fs::exists(folder, error)) {
    throw bad_input("exists", "./" + names.snake + " exists already", "choose another name, or move it away",
                    names.snake);
  }
  // Written beside and renamed, so that what goes wrong leaves nothing.
  const fs::path partial = names.snake + ".part";
  fs::remove_all(partial, error);
  try {
    write_folder(partial, names);
    fs::rename(partial, folder);
  } catch (...) {
    fs::remove_all(partial, error);
    throw;
  }
  std::printf(
      "wrote ./%s\n  cmake -S %s -B %s/build && cmake --build %s/build\n"
      "  loom render -p %s/%s.json --plugins %s/build -o %s.png\n",
      names.snake.c_str(), names.snake.c_str(), names.snake.c_str(), names.snake.c_str(), names.snake.c_str(),
      names.snake.c_str(), names.snake.c_str(), names.snake.c_str());
}

}  // namespace

void add_new_pass(CLI::App& app, Session& session) {
  auto* command = app.add_subcommand("new-pass", "Write the folder of a new pass, ready to build");
  const auto name = std::make_shared<std::string>();
  command->add_option("name", *name, "The pass type: ScreenSpaceGather")->required();
  add_plugin_option(*command, session);
  command->callback([name, &session] { run(*name, session); });
}

}  // namespace loom::cli
