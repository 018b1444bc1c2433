// SPDX-License-Identifier: Apache-2.0
// Interface to the folder of recordings, so that disk errors can be simulated.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace ifog {

// Errors are errno values, 0 for none. One file is open at a time.
class FlightFolder {
 public:
  struct File {
    std::string name;
    std::uint64_t bytes = 0;
    std::int64_t modified_ns = 0;  // wall clock
  };

  virtual ~FlightFolder() = default;
  // Lists the folder, creating it if needed, and locks it; EBUSY if another process uses it.
  virtual int list(std::vector<File>& out) = 0;
  // Creates file `name` and leaves it open. It must not exist.
  virtual int begin(const std::string& name) = 0;
  // Appends all of the bytes to the open file or nothing. ENOENT: the file was removed.
  virtual int append(std::span<const std::uint8_t> bytes) = 0;
  // Syncs the open file, renames it to `name` and closes it in any case.
  virtual int finish(const std::string& name) = 0;
  // Closes the open file unchanged.
  virtual void leave() = 0;
  // Adopts a file left open by a killed recorder; EBUSY: it is still being written.
  virtual int take_over(const std::string& open_name, const std::string& name) = 0;
  virtual int remove(const std::string& name) = 0;

  [[nodiscard]] virtual std::string path() const = 0;
};

std::unique_ptr<FlightFolder> make_flight_folder(std::string path);

}  // namespace ifog
