/* Fills IN into OUT through the C interface: for test_every_door.py. */
#include <stdio.h>

#include "libdem.h"

int main(int argc, char** argv) {
  libdem_dem *holes = NULL, *filled = NULL;
  libdem_error error;
  if (argc != 3) return 2;
  libdem_status status = libdem_read(argv[1], &holes, &error);
  if (!status) status = libdem_fill(holes, NULL, NULL, NULL, &filled, &error);
  if (!status) status = libdem_write(filled, argv[2], 0, &error);
  if (status) fprintf(stderr, "%s\n", error.text);
  libdem_free(filled);
  libdem_free(holes);
  return status;
}
