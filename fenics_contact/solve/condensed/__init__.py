"""The paper's (3.4) on the contact dofs alone: a Schur complement and a dense tangent."""
