// configs/table.sh: the error table, and that it goes on where it was stopped.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "cli/cli.h"

namespace loom::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class Table : public Cli {
 protected:
  [[nodiscard]] ProcessResult table(const std::string& arguments) const {
    return run_process(
        "/bin/bash", {"-c", "LOOM='" LOOM_BINARY_DIR "/bin/loom' '" LOOM_SOURCE_DIR "/configs/table.sh' " + arguments});
  }
  [[nodiscard]] std::string small() const { return "-o '" + dir_.path() + "' --size 12x8 --spp 16 --samples 1"; }
};

TEST_F(Table, HasARowForEachSceneAndPipelineAndKeepsIt) {
  const std::string arguments = small() + " --scene cornell-box --pipeline direct";
  const ProcessResult first = table(arguments);
  ASSERT_EQ(first.exit_code, 0) << first.out << first.err;
  std::istringstream lines(first.out);
  std::string header, rule, row;
  std::getline(lines, header);
  std::getline(lines, rule);
  std::getline(lines, row);
  EXPECT_THAT(header, StartsWith("| scene | pipeline | hdr relMSE |"));
  EXPECT_THAT(row, StartsWith("| cornell-box | direct | "));
  std::vector<std::string> cells;
  std::istringstream fields(row);
  for (std::string cell; std::getline(fields, cell, '|');) cells.push_back(cell);
  ASSERT_EQ(cells.size(), 9u) << row;
  for (std::size_t i = 3; i < cells.size(); ++i) EXPECT_GE(std::stod(cells[i]), 0) << row;
  EXPECT_EQ(std::stod(cells[5]), 0) << "direct light alone makes no indirect light: " << row;
  EXPECT_GT(std::stod(cells[8]), 0) << row;

  // What was measured is not measured again: a row that somebody marked comes back as it is.
  const std::filesystem::directory_iterator rows(dir_ / "rows");
  const std::filesystem::path kept = rows->path();
  std::ofstream(kept) << "| marked |\n";
  EXPECT_THAT(table(arguments).out, HasSubstr("\n| marked |\n"));
  EXPECT_THAT(table(arguments + " --samples 2").out, HasSubstr("\n| cornell-box | direct | ")) << "another measurement";
}

TEST_F(Table, GoesOnWhereOnePipelineFails) {
  const ProcessResult result = table(small() + " --scene cornell-box --pipeline not-there --pipeline direct");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("not-there"));
  EXPECT_THAT(result.out, HasSubstr("\n| cornell-box | direct | "));
  EXPECT_EQ(table("--what 3").exit_code, 2);
}

}  // namespace
}  // namespace loom::test
