// The report in a real browser, where there is one.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "support/process.h"
#include "support/temp_dir.h"

namespace loom::test {
namespace {

constexpr int no_browser = 77;

TEST(Report, OpensFromDiskInARealBrowser) {
  const std::string browse = "exec python3 " LOOM_SOURCE_DIR "/tests/tools/browse_report.py ";
  const TempDir dir;
  std::ofstream(dir / "sweep.json") << R"({ "scenes": ["cornell-box-emissive", "cornell-box"], "size": [16, 16],
    "samples": 1, "frames": 1, "seeds": 1, "reference": { "spp": 512 }, "flicker": { "frames": 4 },
    "pipelines": ["direct", { "pipeline": "area", "set": { "emitter.samples": [1, 4] } }] })";
  const ProcessResult measured =
      run_loom({"measure", dir / "sweep.json", "-o", dir / "report", "--references", dir / "references"});
  ASSERT_EQ(measured.exit_code, 0) << measured.out << measured.err;
  const ProcessResult seen = run_process("/bin/bash", {"-c", browse + "'" + (dir / "report") + "'"});
  if (seen.exit_code == no_browser) GTEST_SKIP() << seen.out;
  EXPECT_EQ(seen.exit_code, 0) << seen.out << seen.err;
}

}  // namespace
}  // namespace loom::test
