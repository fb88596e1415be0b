// Files are written whole or not at all.
#include <csignal>
#include <filesystem>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <darboux/error.h>
#include <darboux/io.h>

#include "io_files.h"

namespace darboux::write_file_test {
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

TEST(WriteFile, ALinkToNothingStaysAndItsFileIsMade) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "sub");
  std::filesystem::create_symlink("sub/file", folder / "middle");
  std::filesystem::create_symlink("middle", folder / "link");
  write_file(folder / "link", "new");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "middle"));
  EXPECT_EQ(test::read_bytes(folder / "sub/file"), "new");
  std::filesystem::create_symlink("loop", folder / "loop");
  EXPECT_THROW(write_file(folder / "loop", "new"), FileError);
}

mode_t mode_of(const std::string& path) {
  struct stat status {};
  EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
  return status.st_mode & 07777;
}

TEST(WriteFile, KeepsTheModeOfWhatItReplaces) {
  const TempFolder folder;
  const mode_t mask = ::umask(022);
  const std::string path = folder / "out";
  write_file(path, "new");
  EXPECT_EQ(mode_of(path), 0644u);
  for (const mode_t mode : {0600u, 0755u, 0666u, 0640u}) {
    ASSERT_EQ(::chmod(path.c_str(), mode), 0);
    write_file(path, "newer");
    EXPECT_EQ(mode_of(path), mode);
  }
  ::umask(mask);
}

TEST(WriteFile, RefusesAFileThatIsReadOnly) {
  const TempFolder folder;
  const std::string path = test::write_bytes(folder / "out", "old");
  ASSERT_EQ(::chmod(path.c_str(), 0444), 0);
  EXPECT_THROW(OutputFile{path}, FileError);  // before any work
  EXPECT_EQ(test::read_bytes(path), "old");
  EXPECT_EQ(folder.files(), 1u);
}

TEST(WriteFile, OtherHardLinksKeepTheOldContent) {
  const TempFolder folder;
  test::write_bytes(folder / "out", "old");
  std::filesystem::create_hard_link(folder / "out", folder / "other");
  write_file(folder / "out", "new");
  EXPECT_EQ(test::read_bytes(folder / "out"), "new");
  EXPECT_EQ(test::read_bytes(folder / "other"), "old");
}

// Until it is complete a file has no name, where the file system knows such files.
TEST(WriteFile, HasNoNameUntilItIsComplete) {
  const TempFolder folder;
  const int unnamed = ::open((folder / "").c_str(), O_TMPFILE | O_WRONLY, 0600);
  if (unnamed < 0) GTEST_SKIP() << "the file system knows no files without a name";
  ::close(unnamed);
  OutputFile file(folder / "out");
  file.write(std::string(5 << 20, 'x'));
  EXPECT_EQ(folder.files(), 0u);
  file.commit();
  EXPECT_EQ(folder.files(), 1u);
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
  // What stands there already stays.
  testing::internal::CaptureStdout();
  write_file("-", "first\n");
  const TempFolder folder;
  std::filesystem::create_symlink("/dev/stdout", folder / "link");
  for (const std::string& path : {std::string("/dev/stdout"), std::string("/dev/fd/1"), folder / "link"}) {
    EXPECT_TRUE(is_standard_output(path)) << path;
    write_file(path, "next\n");
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "first\nnext\nnext\nnext\n");
  EXPECT_FALSE(is_standard_output("out"));
}

}  // namespace
}  // namespace darboux::write_file_test
