// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/sized_rest_filter.h"

namespace ifog {

template class SizedRestFilter<1>;
template class SizedRestFilter<2>;
template class SizedRestFilter<3>;
template class SizedRestFilter<4>;
template class SizedRestFilter<5>;
template class SizedRestFilter<6>;
template class SizedRestFilter<7>;
template class SizedRestFilter<8>;

}  // namespace ifog
