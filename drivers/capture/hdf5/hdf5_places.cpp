// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/hdf5_places.h"

#include <algorithm>
#include <stdexcept>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

// What --group can name: the groups, with all of their path, and the tables of records. A file of very many
// has more than are looked at.
struct Places {
  static constexpr std::size_t kMost = 16, kMostLooked = 4096;
  std::vector<std::string> names{"/"};
  std::size_t looked = 0;

  static herr_t look(hid_t root, const char* name, const H5L_info_t* link, void* to) {
    auto& found = *static_cast<Places*>(to);
    if (++found.looked > kMostLooked || found.names.size() >= kMost) return 1;
    H5O_info_t object{};
    if (link->type != H5L_TYPE_HARD ||
        H5Oget_info_by_name2(root, name, &object, H5O_INFO_BASIC, H5P_DEFAULT) < 0)
      return 0;
    bool place = object.type == H5O_TYPE_GROUP;
    if (object.type == H5O_TYPE_DATASET) {
      const Hdf5Id dataset(H5Dopen2(root, name, H5P_DEFAULT));
      const Hdf5Id type(dataset.good() ? H5Dget_type(dataset) : -1);
      place = type.good() && H5Tget_class(type) == H5T_COMPOUND;
    }
    if (place) found.names.push_back("/" + std::string(name));
    return 0;
  }
};

}  // namespace

const char* kind_of(H5T_class_t kind) {
  return kind == H5T_STRING     ? "text"
         : kind == H5T_COMPOUND ? "records of several members"
         : kind == H5T_ENUM     ? "an enumeration"
                                : "no numbers";
}

std::string list_of(const std::vector<std::string>& names) {
  return names.empty() ? "none" : printable(listed(names), 300);
}

std::vector<std::string> places_of(hid_t file) {
  Places found;
  hdf5_demand(H5Lvisit(file, H5_INDEX_NAME, H5_ITER_INC, Places::look, &found) >= 0,
              "its groups cannot be read");
  return found.names;
}

std::vector<std::string> members_of(hid_t type) {
  std::vector<std::string> names;
  const int count = H5Tget_nmembers(type);
  for (int i = 0; i < count; ++i) {
    char* const name = H5Tget_member_name(type, static_cast<unsigned>(i));
    if (name == nullptr) throw std::runtime_error("its records cannot be read: " + hdf5_reason());
    names.emplace_back(name);
    H5free_memory(name);
  }
  return names;
}

std::string without_index(const std::string& name) {
  const std::size_t open = name.rfind('[');
  return open != std::string::npos && name.back() == ']' ? name.substr(0, open) : name;
}

std::vector<std::string> asked_for(const std::vector<std::string>& names,
                                   const std::function<bool(const std::string&)>& has) {
  std::vector<std::string> out;
  const auto add = [&](const std::string& name) {
    if (std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
  };
  for (const std::string& name : names) {
    std::size_t plus = has(name) ? std::string::npos : name.find('+');
    while (plus != std::string::npos && !(has(name.substr(0, plus)) && has(name.substr(plus + 1))))
      plus = name.find('+', plus + 1);
    add(name.substr(0, plus));
    if (plus != std::string::npos) add(name.substr(plus + 1));
  }
  return out;
}

}  // namespace ifog
