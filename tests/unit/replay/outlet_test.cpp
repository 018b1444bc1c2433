// SPDX-License-Identifier: Apache-2.0
// What `ifog replay` does when the system has no room: the system is a stand-in that answers as told.
#include "tools/ifog/replay/outlet.h"
#include "tests/unit/refusal.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <deque>
#include <string>
#include <thread>
#include <vector>

namespace ifog::tools {
namespace {

// An answer above 0: takes at most so many bytes; 0: takes none; below: fails with this errno.
class ToldOutlet final : public Outlet {
 public:
  explicit ToldOutlet(std::deque<int> answers) : Outlet("can0", -1), answers_(std::move(answers)) {}
  ssize_t write(const void* bytes, std::size_t n) override {
    ++writes_;
    int answer = static_cast<int>(n);
    if (!answers_.empty()) {
      answer = answers_.front();
      answers_.pop_front();
    }
    if (answer < 0) {
      errno = -answer;
      return -1;
    }
    const auto taken = std::min(n, static_cast<std::size_t>(answer));
    sent_.append(static_cast<const char*>(bytes), taken);
    return static_cast<ssize_t>(taken);
  }
  void pause(int error) override { paused_.push_back(error); }

  std::deque<int> answers_;
  std::string sent_;
  std::vector<int> paused_;
  int writes_ = 0;
};

TEST(Outlet, AFullCanQueueIsWaitedForAndTheFrameGoesOnce) {
  ToldOutlet outlet({-ENOBUFS, -ENOBUFS, -EAGAIN, -EINTR});
  EXPECT_TRUE(outlet.send_datagram("frame-1", 7));
  EXPECT_TRUE(outlet.send_datagram("frame-2", 7));
  EXPECT_EQ(outlet.sent_, "frame-1frame-2");
  EXPECT_EQ(outlet.retries(), 3U);  // an interrupted call is not a lack of room
  EXPECT_EQ(outlet.paused_, (std::vector<int>{ENOBUFS, ENOBUFS, EAGAIN}));
}

TEST(Outlet, AFrameOfWhichAPartWentIsAFailure) {
  ToldOutlet outlet({5});
  EXPECT_EQ(test::refusal([&] { outlet.send_datagram("frame-1", 7); }),
            "can0: cannot send: 5 of 7 bytes of a frame were accepted");
}

TEST(Outlet, ShortWritesOfBytesGoOnWhereTheyEnded) {
  ToldOutlet outlet({3, 0, 1, -EAGAIN, 2});
  EXPECT_TRUE(outlet.send_bytes("0123456789", 10));
  EXPECT_EQ(outlet.sent_, "0123456789");
  EXPECT_EQ(outlet.writes_, 6);
  EXPECT_EQ(outlet.retries(), 5U);
  EXPECT_EQ(outlet.paused_, (std::vector<int>{EAGAIN, EAGAIN}));
}

TEST(Outlet, AnyOtherFailureIsOneLine) {
  for (const auto& [error, line] : {std::pair{ENETDOWN, "can0: cannot send: Network is down"},
                                    {EPIPE, "can0: the reader went away"},
                                    {EIO, "can0: cannot send: Input/output error"}}) {
    ToldOutlet outlet({-error});
    EXPECT_EQ(test::refusal([&] { outlet.send_bytes("x", 1); }), line);
  }
}

// The real calls: a socket that takes little at a time, as a serial line does, and a reader that is slow.
TEST(Outlet, ASlowReaderGetsEveryByte) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends), 0);
  ASSERT_EQ(fcntl(ends[0], F_SETFL, O_NONBLOCK), 0);
  const int small = 4096;
  setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &small, sizeof small);
  std::string sent;
  for (int i = 0; i < 300'000; ++i) sent += static_cast<char>(i * 31);
  std::string received;
  std::thread reader([&] {
    char buffer[5000];
    for (ssize_t n = 1; n > 0;) {
      n = read(ends[1], buffer, sizeof buffer);
      if (n > 0) received.append(buffer, static_cast<std::size_t>(n));
    }
  });
  Outlet outlet("line", ends[0]);
  EXPECT_TRUE(outlet.send_bytes(sent.data(), sent.size()));
  close(ends[0]);
  reader.join();
  close(ends[1]);
  EXPECT_EQ(received, sent);
  EXPECT_GT(outlet.retries(), 0U);
}

}  // namespace
}  // namespace ifog::tools
