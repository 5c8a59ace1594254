#include "cli/json_out.h"

#include <cstdio>

namespace loom::cli {

Json versioned() { return {{"version", 1}}; }

Json to_json(const Diagnostics& diagnostics) {
  Json list = Json::array();
  for (const Diagnostic& d : diagnostics.all()) {
    list.push_back({{"severity", to_string(d.severity)},
                    {"code", d.code},
                    {"message", d.message},
                    {"file", d.where.file},
                    {"line", d.where.line},
                    {"column", d.where.column},
                    {"pointer", d.where.pointer},
                    {"hint", d.hint}});
  }
  return list;
}

std::string text_of(const Json& document) {
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void print(const Json& document) {
  const std::string text = text_of(document);
  std::fwrite(text.data(), 1, text.size(), stdout);
}

}  // namespace loom::cli
