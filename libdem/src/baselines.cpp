#include "dem/baselines.h"
