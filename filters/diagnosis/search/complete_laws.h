// SPDX-License-Identifier: Apache-2.0
// What was found of a law is seldom all of it: which of its terms were significant depends on where the
// record happened to be. A swing has a phase that nobody knows, a square a turning point, and a record that
// showed one term of it and not the other is no evidence that there is no other. Elsewhere, on the rest of
// the circle or beyond the range, the missing term is the error.
#pragma once

#include "filters/diagnosis/search/search.h"

namespace ifog {

// Adds to what is proven the terms that its law has besides:
// * of an angle cosine and sine, once a turn and, where the record does not deny it, twice, with coefficients
//   expected about as large as the effect is (by the marginal likelihood), for an arc tells them apart badly;
// * beside a square the linear term, and the other way where the error asks for it, as a turning point is
//   nobody's choice; of an acceleration only where the error asks, for at rest it is zero;
// * beside a product the factor that says about which value of the other one it acts, a scale factor's where
//   the error asks for it, for that is set to right at the reference.
// data: channels as read; reconstructed: as they were, of the fit. Whether there was anything to add.
bool complete_laws(const BlockData& data, const BlockData& reconstructed, SearchResult& found);

}  // namespace ifog
