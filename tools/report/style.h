#pragma once

namespace ifog::report {

// The page's style sheet: colours for light, dark and paper, chosen so that before and after differ in
// lightness too.
extern const char* const kStyle;

}  // namespace ifog::report
