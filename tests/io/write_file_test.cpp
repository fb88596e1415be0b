// Files are written whole or not at all.
#include <csignal>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <darboux/error.h>
#include <darboux/io.h>

#include "io_files.h"

namespace darboux {
namespace {

using test::TempFolder;

TEST(WriteFile, WritesReplacesAndLeavesNothingElse) {
  const TempFolder folder;
  const std::string path = folder / "out.bin";
  const std::string content("a\0b\n", 4);
  write_file(path, content);
  EXPECT_EQ(test::read_bytes(path), content);
  write_file(path, "");
  EXPECT_EQ(test::read_bytes(path), "");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(WriteFile, ALinkStaysAndItsFileIsReplaced) {
  const TempFolder folder;
  test::write_bytes(folder / "file", "old");
  std::filesystem::create_symlink("file", folder / "link");
  write_file(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(test::read_bytes(folder / "file"), "new");
  EXPECT_EQ(folder.files(), 2u);
}

TEST(WriteFile, FailuresAreErrorsAndLeaveNothing) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "sub");
  for (const std::string& path :
       {folder / "missing/out", folder / "sub", folder / "sub/", std::string(), std::string("/dev/full"),
        folder / std::string(300, 'x'), std::string("/proc/nothing")}) {
    SCOPED_TRACE(path);
    EXPECT_THROW(write_file(path, "content"), FileError);
  }
  EXPECT_EQ(folder.files(), 1u);
  EXPECT_TRUE(std::filesystem::is_empty(folder / "sub"));
}

TEST(WriteFile, AFullDiskKeepsTheOldFile) {
  const TempFolder folder;
  const std::string path = folder / "out";
  write_file(path, "old");
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(write_file(path, std::string(5000, 'x')), FileError);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(test::read_bytes(path), "old");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(WriteFile, StandardOutput) {
  testing::internal::CaptureStdout();
  write_file("-", "to stdout\n");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "to stdout\n");
  // What /dev/stdout leads to here is a regular file, which must be written to and not replaced.
  testing::internal::CaptureStdout();
  write_file("/dev/stdout", "by its name\n");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "by its name\n");
  EXPECT_TRUE(std::filesystem::is_symlink("/dev/stdout"));
}

}  // namespace
}  // namespace darboux
