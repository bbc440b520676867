"""Problems of CalculiX's own tests as scenes, against the results that CalculiX states."""
