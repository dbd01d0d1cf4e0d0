#include "dem/baseline.h"
