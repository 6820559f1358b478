// Copyright 2026 The mujoco-torso authors. SPDX-License-Identifier: Apache-2.0
#include "model/csv.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <stdexcept>

namespace torso {
namespace {

class CsvTest : public ::testing::Test {
 protected:
  CsvTest() {
    path = testing::TempDir() + "table_XXXXXX";
    close(mkstemp(path.data()));
  }
  ~CsvTest() override { unlink(path.c_str()); }
  CsvTable table(const std::string& text) const {
    std::ofstream(path, std::ios::binary) << text;
    return CsvTable(path);
  }
  template <typename Call>
  static std::string message(Call call) {
    try {
      call();
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "no error";
  }
  std::string path;
};

TEST_F(CsvTest, ReadsCellsByColumnName) {
  const CsvTable t = table("# comment\nname,x_mm\nleft,1.5\n\n# another\nright,-2e-3\n");
  ASSERT_EQ(t.rows(), 2);
  EXPECT_EQ(t.text(0, "name"), "left");
  EXPECT_EQ(t.number(0, "x_mm"), 1.5);
  EXPECT_EQ(t.number(1, "x_mm"), -0.002);
  EXPECT_EQ(t.find("name", "right"), 1);
}

TEST_F(CsvTest, WordsAreKnownByTheirPlaceInTheList) {
  const CsvTable t = table("name,unit\na,mm\nb,inch\n");
  EXPECT_EQ(t.word(0, "unit", {"m", "mm"}), 1);
  EXPECT_EQ(message([&] {
              t.word(1, "unit", {"m", "mm"});
            }),
            path + ":3: column 'unit' holds 'inch', which is none of m, mm");
  EXPECT_EQ(t.where(1), path + ":3");
}

TEST_F(CsvTest, QuotedCellsMayHoldCommas) {
  const CsvTable t = table("name,source,x\na,\"one, two\",3\n");
  EXPECT_EQ(t.text(0, "source"), "one, two");
  EXPECT_EQ(t.number(0, "x"), 3);
}

TEST_F(CsvTest, ReadsTheLineEndsOfOtherSystems) {
  const CsvTable t = table("name,x\r\na,3\r\n");
  EXPECT_EQ(t.number(0, "x"), 3);
}

TEST_F(CsvTest, EmptyCellIsKnownAsEmptyAndIsNoNumber) {
  const CsvTable t = table("name,x\na,\n");
  EXPECT_TRUE(t.empty(0, "x"));
  EXPECT_FALSE(t.empty(0, "name"));
  EXPECT_EQ(message([&] { t.number(0, "x"); }),
            path + ":2: column 'x' holds '', which is not a number");
}

TEST_F(CsvTest, MessagesNameFileAndLine) {
  EXPECT_EQ(message([] { CsvTable("/no/such/table.csv"); }),
            "/no/such/table.csv: cannot read this anatomy table");
  EXPECT_EQ(message([&] { table("# nothing\n"); }), path + ": the table has no header row");
  EXPECT_EQ(message([&] { table("# one\na,b\n1,2\n3\n"); }),
            path + ":4: 1 cells, the header has 2");
  const CsvTable t = table("# one\na,b\n1,2\n3,4mm\n");
  EXPECT_EQ(message([&] { t.number(1, "b"); }),
            path + ":4: column 'b' holds '4mm', which is not a number");
  EXPECT_EQ(message([&] { t.number(0, "c"); }), path + ": the table has no column 'c'");
  EXPECT_EQ(message([&] { t.find("a", "5"); }), path + ": no row has '5' in column 'a'");
}

TEST_F(CsvTest, InfinityIsNoNumber) {
  for (const char* text : {"inf", "-inf", "nan", "1e999"}) {
    const CsvTable t = table(std::string("a\n") + text + "\n");
    EXPECT_NE(message([&] { t.number(0, "a"); }), "no error") << text;
  }
}

}  // namespace
}  // namespace torso
