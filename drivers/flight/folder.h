// SPDX-License-Identifier: Apache-2.0
// The folder that recordings are kept in, and what can go wrong with it, behind an interface: so that a year
// of full disks can be gone through in a second.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ifog {

// Errors are errno's numbers, 0 for none. One file is open at a time.
class FlightFolder {
 public:
  struct File {
    std::string name;
    std::uint64_t bytes = 0;
    std::int64_t modified_ns = 0;  // wall clock
  };

  virtual ~FlightFolder() = default;
  // What is in it; made if it is not there. From then on it is this one's alone: EBUSY where another has it.
  virtual int list(std::vector<File>& out) = 0;
  // Makes the file `name` and leaves it open. It must not exist.
  virtual int begin(const std::string& name) = 0;
  // Behind what the open file holds: all of it, or nothing is left of it. ENOENT: somebody has removed the file
  // away.
  virtual int append(std::span<const std::uint8_t> bytes) = 0;
  // The open file's content is on the disk, then its name becomes `name`. Closes it in any case.
  virtual int finish(const std::string& name) = 0;
  // Closes the open file as it is.
  virtual void leave() = 0;
  // A file that a recorder which was killed left open; EBUSY: it is still being written.
  virtual int take_over(const std::string& open_name, const std::string& name) = 0;
  virtual int remove(const std::string& name) = 0;

  [[nodiscard]] virtual std::string path() const = 0;
};

std::unique_ptr<FlightFolder> make_flight_folder(std::string path);

}  // namespace ifog
