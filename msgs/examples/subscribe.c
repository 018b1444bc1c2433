// SPDX-License-Identifier: Apache-2.0
/* Prints what ifogd publishes of one sensor: the number of each sample, and of each axis the angle increment
 * in rad and the denoised rate in rad/s.
 *
 *   subscribe_c CHANNEL COUNT [LCM_URL]       subscribe_c IFOG_NOSE 100 'udpm://239.255.76.67:7667?ttl=0'
 *
 * Ends after COUNT messages. Build:  cc subscribe.c $(pkg-config --cflags --libs ifogd-msgs) */
#include <ifog/ifog_rate_t.h>
#include <stdio.h>
#include <stdlib.h>

static void print(const lcm_recv_buf_t* buffer, const char* channel, const ifog_rate_t* message, void* left) {
  (void)buffer;
  (void)channel;
  printf("%lld", (long long)message->seq);
  for (int axis = 0; axis < message->axes; ++axis) {
    printf(" %.9g", message->delta_theta[axis]);
    printf(" %.9g", message->denoised[axis]);
  }
  printf(" %s\n", message->flags & IFOG_RATE_T_FLAG_GAP ? "gap" : "-");
  fflush(stdout);
  --*(long*)left;
}

int main(int argc, char** argv) {
  if (argc < 3) {
    fprintf(stderr, "usage: subscribe_c CHANNEL COUNT [LCM_URL]\n");
    return 2;
  }
  long left = atol(argv[2]);
  lcm_t* lcm = lcm_create(argc > 3 ? argv[3] : NULL);
  if (lcm == NULL) {
    fprintf(stderr, "subscribe_c: no LCM\n");
    return 1;
  }
  ifog_rate_t_subscription_t* subscription = ifog_rate_t_subscribe(lcm, argv[1], print, &left);
  /* LCM keeps 30 messages for who is late, and drops the rest. */
  ifog_rate_t_subscription_set_queue_capacity(subscription, 10000);
  while (left > 0 && lcm_handle(lcm) == 0) {
  }
  lcm_destroy(lcm);
  return left > 0;
}
