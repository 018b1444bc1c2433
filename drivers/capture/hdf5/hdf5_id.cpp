// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/hdf5/hdf5_id.h"

#include <cstring>

namespace ifog {
namespace {

// A fixed-length text is padded by zeros or blanks.
std::string fixed_text(const char* at, std::size_t size, bool blanks) {
  std::string text(at, strnlen(at, size));
  while (blanks && !text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

// Texts of variable length, which most programs can read.
void write_texts(hid_t object, const char* name, const Hdf5Id& space, const std::vector<std::string>& texts) {
  const Hdf5Id type(H5Tcopy(H5T_C_S1));
  std::vector<const char*> at;
  at.reserve(texts.size());
  for (const std::string& text : texts) at.push_back(text.c_str());
  const bool made = type.good() && space.good() && H5Tset_size(type, H5T_VARIABLE) >= 0 &&
                    H5Tset_cset(type, H5T_CSET_UTF8) >= 0;
  const Hdf5Id attribute(made ? H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT)
                              : H5I_INVALID_HID);
  hdf5_demand(attribute.good() && H5Awrite(attribute, type, at.data()) >= 0,
              std::string("cannot write the attribute ") + name);
}

}  // namespace

std::vector<std::string> hdf5_texts(hid_t object, const char* name, std::size_t most, std::size_t longest) {
  std::vector<std::string> out;
  if (H5Aexists(object, name) <= 0) return out;
  const Hdf5Id attribute(H5Aopen(object, name, H5P_DEFAULT));
  if (!attribute.good()) return out;
  const Hdf5Id type(H5Aget_type(attribute)), space(H5Aget_space(attribute));
  if (!type.good() || !space.good() || H5Tget_class(type) != H5T_STRING) return out;
  const hssize_t points = H5Sget_simple_extent_npoints(space);
  if (points <= 0 || static_cast<std::size_t>(points) > most) return out;
  const auto count = static_cast<std::size_t>(points);
  if (H5Tis_variable_str(type) > 0) {
    std::vector<char*> texts(count, nullptr);
    const Hdf5Id memory(H5Tcopy(type));
    if (!memory.good() || H5Aread(attribute, memory, texts.data()) < 0) return out;
    for (const char* text : texts)
      out.emplace_back(text == nullptr ? "" : text, text == nullptr ? 0 : strnlen(text, longest));
    H5Dvlen_reclaim(memory, space, H5P_DEFAULT, texts.data());
    return out;
  }
  const std::size_t size = H5Tget_size(type);
  if (size == 0 || size > longest) return out;
  std::vector<char> block(size * count);
  if (H5Aread(attribute, type, block.data()) < 0) return out;
  const bool blanks = H5Tget_strpad(type) == H5T_STR_SPACEPAD;
  for (std::size_t i = 0; i < count; ++i) out.push_back(fixed_text(block.data() + i * size, size, blanks));
  return out;
}

std::string hdf5_unit(hid_t dataset) {
  constexpr std::size_t kLongest = 64;
  const std::vector<std::string> texts = hdf5_texts(dataset, kHdf5Units, 1, kLongest);
  return texts.empty() ? "" : texts.front();
}

void set_hdf5_texts(hid_t object, const char* name, const std::vector<std::string>& texts) {
  const hsize_t count = texts.size();
  write_texts(object, name, Hdf5Id(H5Screate_simple(1, &count, nullptr)), texts);
}

void set_hdf5_text(hid_t object, const char* name, const std::string& text) {
  write_texts(object, name, Hdf5Id(H5Screate(H5S_SCALAR)), {text});
}

}  // namespace ifog
