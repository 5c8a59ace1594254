// JSON with positions: every value knows its line, column and pointer; every defect is named where it stands.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "loom/json.h"

namespace loom::json {
namespace {

Node good(const std::string& text) {
  Diagnostics diagnostics;
  Node node = parse(text, "f.json", diagnostics);
  for (const auto& diagnostic : diagnostics.all()) ADD_FAILURE() << to_string(diagnostic);
  return node;
}

Diagnostic only_error(const std::string& text) {
  Diagnostics diagnostics;
  parse(text, "f.json", diagnostics);
  EXPECT_EQ(diagnostics.all().size(), 1U) << text;
  return diagnostics.all().empty() ? Diagnostic{} : diagnostics.all().front();
}

void expect_at(const SourceLocation& where, int line, int column, const std::string& pointer) {
  EXPECT_EQ(where.file, "f.json");
  EXPECT_EQ(where.line, line);
  EXPECT_EQ(where.column, column);
  EXPECT_EQ(where.pointer, pointer);
}

TEST(Json, ValuesKnowTheirPlace) {
  const Node root = good("{\n  \"a\": 1,\n  \"b\" : [ true, null,\n \"x\\\"y\", -2.5e1 ],\n\"c/d~\":{ \"e\":{}}}");
  expect_at(root.where, 1, 1, "");
  expect_at(root.find("a")->where, 2, 8, "/a");
  expect_at(root.members[0].key_where, 2, 3, "/a");
  const Node& b = *root.find("b");
  expect_at(b.where, 3, 9, "/b");
  expect_at(b.items[0].where, 3, 11, "/b/0");
  expect_at(b.items[1].where, 3, 17, "/b/1");
  expect_at(b.items[2].where, 4, 2, "/b/2");
  expect_at(b.items[3].where, 4, 10, "/b/3");
  EXPECT_EQ(b.items[2].string, "x\"y");
  EXPECT_EQ(b.items[3].number, -25);
  expect_at(root.find("c/d~")->find("e")->where, 5, 14, "/c~1d~0/e");
}

TEST(Json, ColumnsCountCharactersNotBytes) {
  const Node root = good("{\"é€😀\": 1, \"b\": 2}");
  expect_at(root.find("b")->where, 1, 17, "/b");
}

TEST(Json, AByteOrderMarkTakesNoColumn) { expect_at(good("\xEF\xBB\xBF{\"a\": 1}").find("a")->where, 1, 7, "/a"); }

TEST(Json, CarriageReturnsDoNotMoveLines) { expect_at(good("{\r\n\"a\": 1}").find("a")->where, 2, 6, "/a"); }

TEST(Json, WholeNumbersAreIntegersHoweverWritten) {
  const Node root = good("[16, 16.0, 1e3, 0.5, -0, 9223372036854775807, 18446744073709551615]");
  EXPECT_EQ(root.items[0].kind, Kind::integer);
  EXPECT_EQ(root.items[1].integer, 16);
  EXPECT_EQ(root.items[2].integer, 1000);
  EXPECT_EQ(root.items[3].kind, Kind::number);
  EXPECT_EQ(root.items[4].integer, 0);
  EXPECT_EQ(root.items[5].integer, 9223372036854775807);
  EXPECT_EQ(root.items[6].kind, Kind::number);
  EXPECT_EQ(root.items[6].number, 18446744073709551615.0);
}

TEST(Json, DuplicateKeysAreErrorsAndTheFirstCounts) {
  Diagnostics diagnostics;
  const Node root = parse("{\"a\": 1,\n \"b\": 2,\n \"a\": 3, \"a\": 4}", "f.json", diagnostics);
  ASSERT_EQ(diagnostics.all().size(), 2U);
  EXPECT_EQ(diagnostics.all()[0].code, "duplicate-key");
  expect_at(diagnostics.all()[0].where, 3, 2, "/a");
  EXPECT_THAT(diagnostics.all()[0].hint, testing::HasSubstr("line 1, column 2"));
  ASSERT_EQ(root.members.size(), 2U);
  EXPECT_EQ(root.find("a")->integer, 1);
}

TEST(Json, SyntaxErrorsPointAtTheToken) {
  const Diagnostic comma = only_error("{\n  \"a\": [1, 2,],\n}");
  EXPECT_EQ(comma.code, "json-syntax");
  expect_at(comma.where, 2, 14, "/a/2");
  EXPECT_THAT(comma.hint, testing::HasSubstr("comma"));

  const Diagnostic missing = only_error("{\"a\" 1}");
  EXPECT_EQ(missing.code, "json-syntax");
  EXPECT_EQ(missing.where.column, 6);

  const Diagnostic end = only_error("{\"a\": [1,\n 2");
  EXPECT_EQ(end.code, "json-syntax");
  EXPECT_EQ(end.where.line, 2);
  EXPECT_EQ(end.where.column, 3);
  EXPECT_THAT(end.message, testing::HasSubstr("the file ends here"));

  EXPECT_THAT(only_error("{ // no\n}").hint, testing::HasSubstr("comments"));
  EXPECT_THAT(only_error("{'a': 1}").hint, testing::HasSubstr("double quotes"));
  EXPECT_EQ(only_error("{} {}").code, "json-syntax");
  EXPECT_EQ(only_error("{\"a\": \"open").code, "json-syntax");
}

TEST(Json, NumbersThatAreNotFiniteAreNamed) {
  for (const std::string word : {"NaN", "nan", "Infinity", "-Infinity", "inf", "1e999", "-1e999"}) {
    const Diagnostic diagnostic = only_error("{\"a\": " + word + "}");
    EXPECT_EQ(diagnostic.code, "not-finite") << word;
    EXPECT_THAT(diagnostic.message, testing::HasSubstr("`" + word + "`"));
    expect_at(diagnostic.where, 1, 7, "/a");
  }
}

TEST(Json, DepthIsBounded) {
  good(std::string(64, '[') + std::string(64, ']'));
  const Diagnostic diagnostic = only_error(std::string(65, '[') + std::string(65, ']'));
  EXPECT_EQ(diagnostic.code, "too-deep");
  EXPECT_EQ(diagnostic.where.column, 65);
  EXPECT_EQ(only_error(std::string(1000000, '[')).code, "too-deep");
}

TEST(Json, BytesThatAreNotUtf8AreNamedByPosition) {
  const Diagnostic diagnostic = only_error("{\"a\":\n \"x\xFFy\"}");
  EXPECT_EQ(diagnostic.code, "not-utf8");
  EXPECT_THAT(diagnostic.message, testing::HasSubstr("byte 10 "));
  EXPECT_EQ(diagnostic.where.line, 2);
  EXPECT_EQ(diagnostic.where.column, 4);
  EXPECT_EQ(only_error(std::string("\xFF\xFE{\0}\0", 6)).code, "not-utf8");
  EXPECT_EQ(only_error("{\"\xC3\x28\": 1}").code, "not-utf8");
}

TEST(Json, EmptyTextIsNamed) {
  for (const std::string text : {"", " \n\t", "\xEF\xBB\xBF"}) EXPECT_EQ(only_error(text).code, "file-empty");
}

TEST(Json, FilesThatCannotBeReadAreNamed) {
  Diagnostics diagnostics;
  EXPECT_TRUE(parse_file("no/such/file.json", diagnostics).is(Kind::null));
  EXPECT_TRUE(parse_file(std::filesystem::temp_directory_path().string(), diagnostics).is(Kind::null));
  const std::string path = testing::TempDir() + "loom_json_test.json";
  std::ofstream(path) << "{\"a\": [1, 2, 3]}";
  EXPECT_TRUE(parse_file(path, diagnostics, 8).is(Kind::null));
  EXPECT_EQ(parse_file(path, diagnostics).find("a")->items.size(), 3U);
  std::filesystem::remove(path);
  ASSERT_EQ(diagnostics.all().size(), 3U);
  EXPECT_EQ(diagnostics.all()[0].code, "file-missing");
  EXPECT_EQ(diagnostics.all()[1].code, "file-unreadable");
  EXPECT_EQ(diagnostics.all()[2].code, "file-too-large");
}

TEST(Json, FindOnWhatIsNoObjectIsNull) { EXPECT_EQ(good("[1]").find("a"), nullptr); }

}  // namespace
}  // namespace loom::json
