#include "dem/mcmd.h"
