#include "dem/evaluate.h"
