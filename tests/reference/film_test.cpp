// The accumulation: its error estimate, merging, saving, resuming.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "loom/diagnostic.h"
#include "reference/run.h"
#include "reference/scenes.h"
#include "support/temp_dir.h"

namespace loom::reference::test {
namespace {

constexpr glm::ivec2 size{24, 16};

Film cornell(std::uint32_t samples, const Options& options = {}) {
  return render(cornell_box(), cornell_camera(), size, samples, options);
}

bool same(const Film& a, const Film& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.size().y; ++y) {
    for (int x = 0; x < a.size().x; ++x) {
      if (std::memcmp(&a.pixel(x, y), &b.pixel(x, y), sizeof(PixelSums)) != 0) return false;
    }
  }
  return true;
}

/// Values that lie between two floats, at most.
int ulps(float a, float b) {
  int n = 0;
  for (; a != b && n < 100; ++n) a = std::nextafter(a, b);
  return n;
}

TEST(Determinism, ThreadsDoNotMatter) {
  const Film one = cornell(32, {.threads = 1});
  for (const int threads : {2, 3, 7}) EXPECT_TRUE(same(one, cornell(32, {.threads = threads}))) << threads;
  EXPECT_TRUE(same(one, cornell(32)));
}

TEST(Determinism, SeedsDiffer) { EXPECT_FALSE(same(cornell(16), cornell(16, {.seed = 1}))); }

TEST(Determinism, SamplesInSeveralStepsAreTheSame) {
  const auto scene = cornell_box();
  const auto camera = cornell_camera();
  const PathTracer tracer(scene, camera.eye, {});
  const auto view = view_of(camera, scene, size, camera.eye);
  Film steps(size, {}, 0);
  for (const std::uint32_t samples : {16, 32, 64}) tracer.accumulate(steps, view, samples);
  EXPECT_TRUE(same(steps, cornell(64)));
}

// Two runs merged are one run of both: the sums of the second, added sample by sample behind the first, to 1 ulp.
TEST(Merge, EqualsOneRunOfBoth) {
  const auto scene = cornell_box();
  const auto camera = cornell_camera();
  const auto view = view_of(camera, scene, size, camera.eye);
  Film merged = cornell(32);
  const Film second = cornell(48, {.seed = 1});
  merged.merge(second);
  EXPECT_EQ(merged.least_count(), 80U);
  EXPECT_EQ(merged.seeds(), (std::vector<std::uint64_t>{0, 1}));

  // The samples of the second run, one round after the other, on top of the first.
  Film both = cornell(32);
  Film before(size, {}, 1);
  const PathTracer tracer(scene, camera.eye, {.seed = 1});
  for (std::uint32_t samples = 16; samples <= 48; samples += 16) {
    Film after = before;
    tracer.accumulate(after, view, samples);
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        PixelSums& p = both.pixel(x, y);
        const PixelSums &a = after.pixel(x, y), &b = before.pixel(x, y);
        for (std::size_t r = 0; r < replicates; ++r) p.radiance[r] += a.radiance[r] - b.radiance[r];
        p.direct += a.direct - b.direct;
        p.emitter += a.emitter - b.emitter;
        p.bounce += a.bounce - b.bounce;
        p.albedo += a.albedo - b.albedo;
        p.normal += a.normal - b.normal;
        p.depth += a.depth - b.depth;
        p.count += a.count - b.count;
        p.hits += a.hits - b.hits;
      }
    }
    before = after;
  }
  const ImageLayers m = merged.layers(), b = both.layers();
  for (const auto& [name, values] : m.channels) {
    int worst = 0;
    // A float near 0 (a normal's component, say) has ulps far below the rounding of the doubles that cancel in it.
    for (std::size_t i = 0; i < values.size(); ++i) {
      const float other = b.channels.at(name)[i];
      if (std::abs(values[i] - other) > 1e-14F) worst = std::max(worst, ulps(values[i], other));
    }
    EXPECT_LE(worst, 1) << name;
  }
}

TEST(Merge, RefusesWhatDoesNotBelongTogether) {
  Film film = cornell(16);
  EXPECT_THROW(film.merge(cornell(16)), BadInput);                             // the same seed
  EXPECT_THROW(film.merge(cornell(16, {.bounces = 2, .seed = 1})), BadInput);  // another picture
  EXPECT_THROW(film.merge(render(cornell_box(), cornell_camera(), {8, 8}, 16, {.seed = 1})), BadInput);
  EXPECT_EQ(film.least_count(), 16U);
}

// Mean of many short runs, within the confidence interval of one long one: nothing depends on the run's length.
TEST(Unbiased, ShortRunsAgreeWithALongOne) {
  const Film longer = cornell(512, {.seed = 1000});
  Film shorter = cornell(16);
  for (std::uint64_t seed = 1; seed < 16; ++seed) shorter.merge(cornell(16, {.seed = seed}));
  glm::dvec3 difference(0), variance(0);
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const auto &a = shorter.pixel(x, y), &b = longer.pixel(x, y);
      difference += Film::mean(a) - Film::mean(b);
      variance += Film::standard_error(a) * Film::standard_error(a) + Film::standard_error(b) * Film::standard_error(b);
    }
  }
  for (glm::length_t c = 0; c < 3; ++c) EXPECT_LT(std::abs(difference[c]), confidence * std::sqrt(variance[c]));
}

// Roulette on and off agree, at a limit that both share. Away from the lamp: its edges are noise of the pixel alone.
TEST(Unbiased, RouletteOnAndOffAgree) {
  scene::Camera camera = cornell_camera();
  camera.target.y = 1.5;
  camera.yfov_rad = .3;
  const scene::Scene scene = cornell_box();
  const Film on = render(scene, camera, size, 256, {.bounces = 6});
  const Film off = render(scene, camera, size, 256, {.bounces = 6, .seed = 1, .roulette = false});
  const auto mean_of = [](const Film& film) {
    Estimate e;
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        e.mean += Film::mean(film.pixel(x, y));
        const auto s = Film::standard_error(film.pixel(x, y));
        e.error += s * s;
      }
    }
    e.error = glm::sqrt(e.error);
    return e;
  };
  const Estimate a = mean_of(on), b = mean_of(off);
  expect_mean_within({a.mean, glm::sqrt(a.error * a.error + b.error * b.error)}, b.mean, .02);
}

// The standard error predicts the true one within 1.3: root mean squares over the image, against a run of 64 times as
// many samples.
TEST(StandardError, PredictsTheTrueError) {
  const Film truth = cornell(4096, {.seed = 99});
  for (const std::uint32_t samples : {16U, 64U}) {
    const Film film = cornell(samples);
    double predicted = 0, actual = 0;
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const glm::dvec3 mean = Film::mean(truth.pixel(x, y));
        const glm::dvec3 weight = 1. / (mean * mean + 1e-2);
        const glm::dvec3 e = Film::standard_error(film.pixel(x, y)), d = Film::mean(film.pixel(x, y)) - mean;
        predicted += glm::dot(weight, e * e);
        actual += glm::dot(weight, d * d);
      }
    }
    const double ratio = std::sqrt(predicted / actual);
    EXPECT_GT(ratio, 1 / 1.3) << samples;
    EXPECT_LT(ratio, 1.3) << samples;
  }
}

TEST(StandardError, OfUnequalReplicatesAndOfNone) {
  PixelSums sums;
  EXPECT_EQ(Film::standard_error(sums), glm::dvec3(0));
  Film::add(sums, {.radiance = glm::vec3(1)});
  EXPECT_EQ(Film::standard_error(sums), glm::dvec3(0));  // one sample says nothing
  Film::add(sums, {.radiance = glm::vec3(3)});
  EXPECT_EQ(Film::mean(sums), glm::dvec3(2));
  EXPECT_NEAR(Film::standard_error(sums).x, 1, 1e-12);  // √(((1−2)²+(3−2)²)/(2·1))
}

TEST(FilmFile, KeepsEverything) {
  const loom::test::TempDir dir;
  Film film = cornell(16);
  film.seconds = 12.5;
  film.save(dir / "a.film");
  const Film back = Film::load(dir / "a.film");
  EXPECT_TRUE(same(film, back));
  EXPECT_EQ(back.seeds(), film.seeds());
  EXPECT_EQ(back.identity(), film.identity());
  EXPECT_EQ(back.seconds, 12.5);
  EXPECT_EQ(back.rays, film.rays);
}

TEST(FilmFile, DamageIsFound) {
  const loom::test::TempDir dir;
  cornell(16).save(dir / "a.film");
  std::ifstream in(dir / "a.film", std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  const auto refused = [&](const std::string& bytes) {
    dir.write("b.film", bytes);
    EXPECT_THROW((void)Film::load(dir / "b.film"), BadInput);
  };
  refused("");
  refused(whole.substr(0, 20));
  refused(whole.substr(0, whole.size() - 1));
  std::string bytes = whole;
  bytes[bytes.size() / 2] ^= 1;
  refused(bytes);
  bytes = whole;
  bytes[16] = bytes[20] = 127;  // a huge size in the header asks for no memory
  bytes[19] = bytes[23] = 127;
  refused(bytes);
  EXPECT_THROW((void)Film::load(dir / "none.film"), BadInput);
}

/// A run of the Cornell box in a folder.
class RunTest : public ::testing::Test {
 protected:
  Film open(std::uint64_t seed = 0) { return open_film(path_, size, identify(scene_, camera_, size, {}), seed); }
  void go(Film& film, const Target& target, const std::function<bool(const Progress&)>& report = {}) {
    run(PathTracer(scene_, camera_.eye, {}), film, view_, target, {.path = path_, .every_s = 0}, report);
  }

  loom::test::TempDir dir_;
  std::string path_ = dir_ / "ref.exr.film";
  scene::Scene scene_ = cornell_box();
  scene::Camera camera_ = cornell_camera();
  interop::Camera view_ = view_of(camera_, scene_, size, camera_.eye);
};

// Stopped in the middle of a round, then taken up again from the file: bit for bit the run that was not.
TEST_F(RunTest, ResumesWhereItWasInterrupted) {
  for (const Target& target : {Target{.samples = 48}, Target{.noise = .08}}) {
    std::filesystem::remove(path_);
    Film whole = open();
    go(whole, target);
    std::filesystem::remove(path_);
    for (int interruptions = 0; interruptions < 3; ++interruptions) {
      Film part = open();
      int reports = 0;
      go(part, target, [&](const Progress&) { return ++reports < 2; });
    }
    EXPECT_GT(open().most_count(), open().least_count()) << "meant to be interrupted within a round";
    Film rest = open();
    go(rest, target);
    EXPECT_TRUE(same(whole, rest));
    EXPECT_TRUE(same(whole, open()));
    // A third call finds it done.
    const std::uint64_t rays = rest.rays;
    go(rest, target);
    EXPECT_EQ(rest.rays, rays);
  }
}

TEST_F(RunTest, StopsAtTheNoiseAskedFor) {
  Film film = open();
  go(film, {.noise = .08});
  EXPECT_LE(film.relative_error(), .08);
  EXPECT_GT(film.relative_error(), .06);
}

TEST_F(RunTest, RefusesToContinueAnotherRun) {
  Film film = open();
  go(film, {.samples = 16});
  EXPECT_THROW((void)open(1), BadInput);
  EXPECT_THROW((void)open_film(path_, size, identify(scene_, camera_, size, {.bounces = 1}), 0), BadInput);
  EXPECT_THROW((void)open_film(path_, {8, 8}, film.identity(), 0), BadInput);
}

TEST_F(RunTest, ProgressGrowsToOne) {
  Film film = open();
  double last = 0;
  go(film, {.samples = 64}, [&](const Progress& p) {
    EXPECT_GE(p.fraction, last);
    EXPECT_LE(p.fraction, 1);
    EXPECT_EQ(p.expected, 64U);
    last = p.fraction;
    return true;
  });
  EXPECT_GT(last, .9);
}

}  // namespace
}  // namespace loom::reference::test
