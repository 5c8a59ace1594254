#include "graph/random_graph.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <random>
#include <set>

#include "graph/fakes.h"

namespace loom::test {
namespace {

constexpr int inputs_at_most = 3;
constexpr std::array<const char*, inputs_at_most> input_names = {"a", "b", "c"};

/// Reads up to three images and makes one, each by its own kind of access.
Declared::Reflect node(TextureDesc desc, Access in, Access out) {
  return [=](Ports& ports, const SceneFacts&) {
    for (const char* name : input_names) ports.in(name, "Image").optional().reads("image", in);
    ports.in("last", "Image").optional().reads("image");
    ports.out("image", "Image").texture("image", desc, out);
    ports.scratch("tmp", desc, Access::image_read_write);
    ports.scratch("list", BufferDesc{.bytes = 64U * static_cast<unsigned>(desc.width)});
    ports.scratch("long_list", BufferDesc{.bytes = 96U * static_cast<unsigned>(desc.width)});
  };
}

struct Type {
  const char* name;
  TextureDesc desc;
  Access in, out;
};

const std::array<Type, 5>& types() {
  static const std::array<Type, 5> list = {{
      {"Raster", TextureDesc::image({512, 512}, Format::rgba16f), Access::sampled, Access::color},
      {"Compute", TextureDesc::image({512, 512}, Format::rgba16f), Access::sampled, Access::image_write},
      {"Load", TextureDesc::image({256, 256}, Format::rgba16f), Access::image_read, Access::image_read_write},
      {"Volume", TextureDesc::volume(32, Format::rgba16f), Access::sampled, Access::image_write},
      {"Layers", TextureDesc::layers({64, 64}, 4, Format::r32f), Access::image_read, Access::color},
  }};
  return list;
}

class Generator {
 public:
  Generator(unsigned seed, int passes) : random_(seed), count_(passes) {}

  RandomGraph run() {
    // Creation order is topological; the file lists the passes in another order.
    for (int i = 0; i < count_; ++i) created_.push_back("p" + std::to_string(i));
    graph_.names = created_;
    std::shuffle(graph_.names.begin(), graph_.names.end(), random_);
    for (int i = 0; i < count_; ++i) bodies_[created_[index(i)]] = body(i);
    forbid_reading_what_is_overwritten();
    write();
    return std::move(graph_);
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(random_); }
  bool chance(int percent) { return below(100) < percent; }

  /// Prefers recent passes, as pipelines do, so that lifetimes end.
  std::string earlier(int i) { return created_[index(std::max(0, i - 1 - below(std::min(i, 12))))]; }

  void depend(const std::string& pass, const std::string& on) {
    graph_.reads[pass].push_back(on);
    graph_.must_precede.emplace_back(on, pass);
  }

  std::string body(int i) {
    const std::string& name = created_[index(i)];
    if (i > 2 && chance(10)) {
      const std::string target = earlier(i);
      // Later passes do not read the old value.
      if (!overwritten_.contains(target) && !sinks_.contains(target)) {
        overwritten_.insert(target);
        for (const auto& reader : readers_[target]) graph_.must_precede.emplace_back(reader, name);
        depend(name, target);
        return R"("type": "InPlace", "in": { "image": ")" + target + ".image\" }";
      }
    }
    if (i > 0 && chance(4)) {
      const std::string source = readable(i);
      if (!source.empty()) {
        depend(name, source);
        readers_[source].push_back(name);
        graph_.roots.push_back(name);
        sinks_.insert(name);
        return R"("type": "End", "in": { "image": ")" + source + ".image\" }";
      }
    }
    return ordinary(i, name);
  }

  std::string readable(int i) {
    for (int attempt = 0; attempt < 8; ++attempt) {
      const std::string source = earlier(i);
      if (!overwritten_.contains(source) && !sinks_.contains(source)) return source;
    }
    return {};
  }

  std::string ordinary(int i, const std::string& name) {
    std::string in;
    const int wires = i == 0 ? 0 : below(inputs_at_most + 1);
    std::set<std::string> used;
    for (int w = 0; w < wires; ++w) {
      const std::string source = readable(i);
      if (source.empty()) continue;
      in += (in.empty() ? "\"" : ", \"") + std::string(input_names[index(w)]) + "\": \"" + source + ".image\"";
      if (!used.insert(source).second) continue;
      depend(name, source);
      readers_[source].push_back(name);
    }
    if (chance(5)) {
      const std::string source = created_[index(below(count_))];
      pending_history_.emplace_back(name, source);
      in += std::string(in.empty() ? "" : ", ") + "@" + name + "@";
    }
    return "\"type\": \"" + std::string(types()[index(below(static_cast<int>(types().size())))].name) +
           "\", \"in\": { " + in + " }";
  }

  /// History wires were drawn before it was known which pass overwrites what and which makes no image.
  void forbid_reading_what_is_overwritten() {
    for (const auto& [reader, source] : pending_history_) {
      std::string& text = bodies_[reader];
      const std::string mark = "@" + reader + "@";
      const auto place = text.find(mark);
      if (overwritten_.contains(source) || sinks_.contains(source)) {
        const bool follows = place >= 2 && text[place - 2] == ',';
        text.erase(follows ? place - 2 : place, mark.size() + (follows ? 2 : 0));
        continue;
      }
      text.replace(place, mark.size(), "\"last\": \"" + source + ".image@prev\"");
      graph_.reads[reader].push_back(source);
    }
  }

  void write() {
    std::string& text = graph_.text;
    text = "{ \"passes\": {";
    for (std::size_t i = 0; i < graph_.names.size(); ++i)
      text += (i == 0 ? "\n" : ",\n") + ("  \"" + graph_.names[i] + "\": { ") + bodies_[graph_.names[i]] + " }";
    text += "\n}, \"outputs\": {";
    int outputs = 0;
    for (int i = count_ - 1; i >= 0 && outputs < 3; --i) {
      const std::string& name = created_[index(i)];
      if (overwritten_.contains(name) || sinks_.contains(name) || (outputs > 0 && !chance(30))) continue;
      static constexpr std::array<const char*, 3> keys = {"image", "hdr", "bounce"};
      text += (outputs == 0 ? "\"" : ", \"") + std::string(keys[index(outputs)]) + "\": \"" + name + ".image\"";
      graph_.roots.push_back(name);
      ++outputs;
    }
    text += "} }\n";
  }

  std::mt19937 random_;
  int count_;
  RandomGraph graph_;
  std::vector<std::string> created_;
  std::map<std::string, std::string> bodies_;
  std::map<std::string, std::vector<std::string>> readers_;
  std::vector<std::pair<std::string, std::string>> pending_history_;
  std::set<std::string> overwritten_, sinks_;
};

}  // namespace

RandomGraph random_graph(unsigned seed, int passes) { return Generator(seed, passes).run(); }

Registry random_registry() {
  Registry registry;
  for (const auto& type : types()) add(registry, type.name, node(type.desc, type.in, type.out));
  add(registry, "InPlace", [](Ports& ports, const SceneFacts&) {
    ports.in("image", "Image").reads("image", Access::image_read_write);
    ports.out("image", "Image").in_place("image");
  });
  add(registry, "End", [](Ports& ports, const SceneFacts&) {
    ports.in("image", "Image").reads("image");
    ports.side_effect();
  });
  return registry;
}

}  // namespace loom::test
